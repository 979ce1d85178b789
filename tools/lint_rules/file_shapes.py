"""Files over 250 lines are noted (long tables are fine, long reasoning is not); a source has a header of its stem."""

from pathlib import Path

LONG_FILE_LINES = 250
# Programs and modules, which no file includes.
WITHOUT_HEADER = {"main.cpp", "module.cpp", "png_module.cpp", "png_module_libpng.cpp"}


def long_files(files):
    lengths = [(path.read_text(encoding="utf-8", errors="replace").count("\n"), path)
               for path in files if path.suffix in {".h", ".cpp", ".py"}]
    for lines, path in sorted(lengths, reverse=True):
        if lines > LONG_FILE_LINES:
            yield f"{path} has {lines} lines"


def check(files):
    for path in files:
        if path.suffix != ".cpp" or path.parts[0] not in {"lib", "formats", "tools"} or "bench" in path.parts:
            continue
        if path.name not in WITHOUT_HEADER and not path.with_suffix(".h").exists():
            yield f"{path}: has no header of its stem: {Path(path).with_suffix('.h').name}"

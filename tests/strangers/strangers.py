"""How many files does a newcomer touch? Does to a copy of the tree what the pages say, builds it, runs what was added.

strangers.py [BUILD_FOLDER]. A page gives a new file as a block ```cpp whose first line is `// FILE`, and an edit as a block
```diff whose first line is `--- FILE`: below a line that begins with a space come those with +, in place of text after - comes
that after +. Text is looked for without the space around it, and must stand there once.
"""
import json
import os
import re
import struct
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RECORDING = "dumps/tiny/chess.spool"


@dataclass(frozen=True)
class Stranger:
    what: str
    page: str
    section: str  # the heading above its blocks
    most: int     # files, new ones and edited ones


STRANGERS = (Stranger("filter", "docs/own_methods.md", "A filter in C++", 4),
             Stranger("sampler", "docs/own_methods.md", "A sampler in C++", 4),
             Stranger("option", "docs/own_methods.md", "An option more", 4),
             Stranger("metric", "docs/own_metric.md", "In the library", 4),
             Stranger("import format", "docs/own_import.md", "An import format of the program", 5))


def blocks(stranger):
    """({file: text} of new files, {file: lines} of edits) of a section of a page."""
    sections = re.split(r"^## ", (ROOT / stranger.page).read_text(), flags=re.MULTILINE)
    section, = (text for text in sections if text.startswith(stranger.section + "\n"))
    new = dict(re.findall(r"^```cpp\n// ((?:lib|formats)/\S+)\n(.*?)^```$", section, re.MULTILINE | re.DOTALL))
    edits = {file: text.splitlines() for file, text in re.findall(r"^```diff\n--- (\S+)\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)}
    return new, edits


def edited(text, lines, file):
    """`text` after the edits of a block."""
    def place(wanted):
        found = text.count(wanted.strip())
        assert found == 1, f"{file}: {wanted.strip()!r} stands there {found} times"
        return text.index(wanted.strip())
    i = 0
    while i < len(lines):
        mark, anchor = lines[i][:1], lines[i][1:]
        added = []
        while i + 1 < len(lines) and lines[i + 1].startswith("+"):
            i += 1
            added.append(lines[i][1:])
        i += 1
        at = place(anchor)
        if mark == "-":
            text = text[:at] + "\n".join(added) + text[at + len(anchor.strip()):]
        else:
            assert mark == " " and added, f"{file}: {anchor!r} says nothing to do"
            end = text.index("\n", at) + 1
            text = text[:end] + "".join(line + "\n" for line in added) + text[end:]
    return text


def copy_tree(target):
    """The tracked files, as they are; what did not change keeps its time, so that a second run compiles little."""
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    tree = {name: (ROOT / name).read_bytes() for name in files.split("\0") if name and (ROOT / name).is_file()}
    for stranger in STRANGERS:
        new, edits = blocks(stranger)
        touched = len(new) + len(edits)
        print(f"{stranger.what}: {len(new)} new files, {len(edits)} edited: {', '.join([*new, *edits])}")
        assert new or edits, f"{stranger.page}: nothing below '{stranger.section}'"
        assert touched <= stranger.most, f"{stranger.what}: {touched} files, at most {stranger.most}"
        for name, text in new.items():
            assert name not in tree, f"{name} is there"
            tree[name] = text.encode()
        for name, lines in edits.items():
            tree[name] = edited(tree[name].decode(), lines, name).encode()
    for name, data in tree.items():
        path = target / name
        if path.is_file() and path.read_bytes() == data:
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    for path in (path for path in target.rglob("*") if path.is_file()):
        name = path.relative_to(target).as_posix()
        if name not in tree and not name.startswith("build/"):
            path.unlink()


def build(tree):
    environment = {**os.environ, "CCACHE_BASEDIR": os.environ.get("CCACHE_BASEDIR", str(tree))}
    jobs = os.environ.get("SPOOL_JOBS", str(os.cpu_count()))
    subprocess.run(["cmake", "--preset", "release", "-DSPOOL_BUILD_TESTS=OFF"], cwd=tree, env=environment, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", "build/release", "-j", jobs, "--quiet", "spool"], cwd=tree, env=environment, check=True)
    return tree / "build/release/spool"


def try_out(program, folder):
    """Each addition, used as a user would."""
    def spool(*arguments):
        done = subprocess.run([program, *map(str, arguments)], cwd=folder, capture_output=True, text=True)
        assert done.returncode == 0, f"spool {' '.join(map(str, arguments))}: {done.stderr}"
        return done.stdout
    recording = ROOT / RECORDING
    folder.mkdir(parents=True, exist_ok=True)

    def error(*arguments):
        spool("reconstruct", recording, "--spp", 8, *arguments, "--force", "-o", "image.exr")
        spool("reconstruct", recording, "--filter", "box", "--force", "-o", "all.exr")
        return json.loads(spool("metrics", "image.exr", "all.exr", "--json"))

    def metric(table, name):
        return table["metrics"][name]["value"] if "metrics" in table else table[name]

    box, median, wide = (error("--filter", "box"), error("--filter", "median"),
                         error("--filter", "median", "--set", "filter.radius=3"))
    assert len({metric(table, "mse") for table in (box, median, wide)}) == 3
    assert metric(box, "log_error") > metric(median, "log_error") > 0
    assert "log_error" in spool("list", "metrics")
    gaussian, clamped = error("--filter", "gaussian"), error("--filter", "gaussian", "--set", "filter.border=clamp")
    assert metric(gaussian, "mse") != metric(clamped, "mse")

    def spent(first):
        text = spool("replay", recording, "--sampler", "two_stage", "--set", f"sampler.first={first}", "--spp", 8, "--json", "--force", "-o", "n.exr")
        return json.loads(text)
    assert spent(0.5)["spent"] == spent(1)["spent"] == 8 * 64 * 64
    assert spent(0.5)["initial"] == 4 * 64 * 64

    width, height, samples = 5, 4, 3
    values = [0.25 * v for v in range(3 * width * height * samples)]
    (folder / "in.raw").write_bytes(struct.pack("<3i", width, height, samples) + struct.pack(f"<{len(values)}f", *values))
    spool("pack", "--from", "raw-passes", "in.raw", "--force", "-o", "packed.spool")
    assert json.loads(spool("pixel", "packed.spool", "--at", "1,0", "--json"))[0]["samples"][1] == values[3 * width * height + 3:][:3]
    (folder / "cut.raw").write_bytes((folder / "in.raw").read_bytes()[:-4])
    refused = subprocess.run([program, "pack", "--from", "raw-passes", "cut.raw", "-o", "cut.spool"], cwd=folder, capture_output=True, text=True)
    assert refused.returncode == 1 and "cut.raw" in refused.stderr, refused.stderr


def main():
    target = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/strangers").resolve()
    copy_tree(target / "tree")
    program = build(target / "tree")
    try_out(program, target / "run")
    print("every one of them works")


if __name__ == "__main__":
    main()

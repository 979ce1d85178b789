"""Every door takes no memory and no time on a file's word: 4 KiB in, less than 256 MiB and a second of CPU time."""
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest
import spool

import hostile_files
from conftest import LONGEST_RUN, PROGRAM, samples, write_dump

SLOW = int(os.environ.get("SPOOL_TIMEOUT_FACTOR", "1"))
MOST_BYTES, MOST_SECONDS = 256 << 20, 1.0 * SLOW
# The peak of a process counts that of the one it was forked from, so a small one starts the program.
LAUNCHER = ("import os, sys\nchild = os.fork()\nif child == 0: os.execv(sys.argv[1], sys.argv[1:])\n_, status, used = os.wait4(child, 0)\n"
            "print(os.waitstatus_to_exitcode(status), used.ru_maxrss << 10, used.ru_utime + used.ru_stime, file=sys.stderr)")


def cost(*arguments, cwd):
    """Exit code (negative: a signal), lines of stderr, peak of memory in bytes, seconds of CPU time."""
    done = subprocess.run([sys.executable, "-I", "-S", "-c", LAUNCHER, PROGRAM, *map(str, arguments)], cwd=cwd, text=True, errors="replace",
                          capture_output=True, timeout=LONGEST_RUN)
    *lines, last = done.stderr.splitlines()
    code, memory, seconds = last.split()
    return int(code), lines, int(memory), float(seconds)


def refused(*arguments, cwd, codes=(1, 2, 4)):
    code, lines, memory, seconds = cost(*arguments, cwd=cwd)
    assert code in codes and len(lines) == 1, (arguments, code, lines)
    cheap(arguments, memory, seconds)
    return lines[0]


def cheap(what, memory, seconds):
    print(f"{memory / 2**20:6.0f} MiB {seconds:5.2f} s  {what}")
    assert seconds < MOST_SECONDS, (what, seconds)
    assert SLOW > 1 or memory < MOST_BYTES, (what, memory)  # a sanitizer has memory of its own


@pytest.fixture
def small(tmp_path):
    return write_dump(tmp_path / "small.spool", samples(4, 4, 4)[0])


def exr_doors(path, dump, folder):
    """The commands that read an EXR image."""
    out = folder / "out"
    return {"metrics": ("metrics", path, path), "selection": ("reconstruct", dump, "--selection", path, "--filter", "box", "-o", f"{out}.exr"),
            "image": ("reconstruct", dump, "--filter", f"image:{path}", "-o", f"{out}.exr"),
            "counts": ("replay", dump, "--sampler", f"counts:{path}", "--spp", 2, "-o", f"{out}.exr"),
            "deep-exr": ("pack", "--from", "deep-exr", path, "-o", f"{out}.spool"),
            "deep samples": ("pack", "--from", "deep-exr", "--set", "import.deep_samples=on", path, "-o", f"{out}.spool"),
            "exr-folder": ("pack", "--from", "exr-folder", path.parent, "-o", f"{out}.spool"),
            "bcd-stats": ("convert", dump, "--to", "bcd-stats", "--set", f"export.selection={path}", "-o", out)}


@pytest.mark.parametrize("door", exr_doors(Path("folder/image"), "dump", Path("folder")))
def test_no_exr_takes_memory_on_its_headers_word(tmp_path, small, door):
    folder = tmp_path / "images"
    folder.mkdir()
    for name, data in hostile_files.exr_bombs().items():
        assert len(data) < 4096, name
        path = folder / "sample_0001.exr"
        path.write_bytes(data)
        line = refused(*exr_doors(path, small, tmp_path)[door], cwd=tmp_path)
        assert "sample_0001.exr" in line, (name, line)
    assert not list(tmp_path.glob("out*"))


def test_a_picture_of_another_size_is_not_decoded(tmp_path, small):
    for name, side in (("huge.exr", 8000), ("small.exr", 4)):
        output = OpenImageIO.ImageOutput.create(str(tmp_path / name))
        spec = OpenImageIO.ImageSpec(side, side, 1, "half")
        spec.channelnames = ["Y"]
        assert output.open(str(tmp_path / name), spec) and output.write_image(np.ones((side, side, 1), "f2")) and output.close()
    (tmp_path / "plan.toml").write_text(f'recordings = ["{small}"]\nspp = [2]\nsamplers = ["uniform"]\nfilters = ["box"]\n'
                                        '[[mask]]\nname = "m"\nfile = "huge.exr"\n')
    for words in (["evaluate", "plan.toml", "-o", "out"], ["metrics", "huge.exr", "small.exr"], ["metrics", "small.exr", "huge.exr"], ["metrics", "small.exr", "small.exr", "--variance", "huge.exr"],
                  ["metrics", "small.exr", "small.exr", "--mask", "m=huge.exr"], ["reconstruct", small, "--selection", "huge.exr", "--filter", "box", "-o", "out.exr"],
                  ["reconstruct", small, "--filter", "image:huge.exr", "-o", "out.exr"],
                  ["reconstruct", small, "--filter", f"exec:cp {tmp_path / 'huge.exr'} $2 #", "-o", "out.exr"],
                  ["replay", small, "--sampler", f"exec:cp {tmp_path / 'huge.exr'} $2 #", "--spp", 2, "--set", "sampler.init_spp=1", "-o", "out.exr"]):
        assert "8000 x 8000" in refused(*words, cwd=tmp_path, codes=(1,))


def test_no_zarr_store_becomes_much_larger_than_it_is(tmp_path):
    for name, path in hostile_files.zarr_bombs(tmp_path).items():
        assert path.stat().st_size < 16384, name
        refused("pack", "--from", "noisebase", path, "-o", "out.spool", *(("--set", "import.frame=0") if "frames" in name else ()), cwd=tmp_path)
    assert not list(tmp_path.glob("out*"))


def test_a_store_that_may_grow_is_taken_with_the_users_word(tmp_path):
    path = hostile_files.zarr_bombs(tmp_path)["many chunks"]
    line = refused("pack", "--from", "noisebase", path, "-o", "out.spool", cwd=tmp_path, codes=(1,))
    needed = re.search(r"--max-expansion (\d+)", line).group(1)
    done = subprocess.run([PROGRAM, "pack", "--from", "noisebase", path, "-o", "out.spool", "--compress", "--max-expansion", needed], cwd=tmp_path,
                          capture_output=True, timeout=LONGEST_RUN)
    assert done.returncode == 0, done.stderr
    assert spool.open(tmp_path / "out.spool").width == 1024


def test_no_bcd_file_takes_memory_on_its_headers_word(tmp_path):
    whole, bombs = hostile_files.bcd_bombs()
    (tmp_path / "a.raw").write_bytes(whole)
    assert cost("pack", "--from", "bcd", "a.raw", "-o", "whole.spool", cwd=tmp_path)[0] == 0
    for name, data in bombs.items():
        assert len(data) < 4096, name
        (tmp_path / "a.raw").write_bytes(data)
        line = refused("pack", "--from", "bcd", "a.raw", "-o", "out.spool", cwd=tmp_path, codes=(1, 4))
        assert "a.raw" in line, (name, line)
    assert not list(tmp_path.glob("out*"))


def test_no_sbmc_tile_takes_memory_on_its_word(tmp_path):
    whole, bombs = hostile_files.sbmc_bombs(tmp_path)
    (tmp_path / "whole_tile.bin").write_bytes(whole)
    assert cost("pack", "--from", "sbmc", "whole_tile.bin", "--set", "import.scale=raw", "-o", "whole.spool", cwd=tmp_path)[:2] == (0, [])
    for name, path in bombs.items():
        assert path.stat().st_size < 8192, name
        for scale in ((), ("--set", "import.scale=raw")):
            line = refused("pack", "--from", "sbmc", path.name, *scale, "-o", "out.spool", cwd=tmp_path, codes=(1, 2, 3, 4))
            assert len(line) < 8192, (name, line)
    assert not list(tmp_path.glob("out*"))


def test_arrays_of_zeros_are_bounded_too(tmp_path):
    meta = np.frombuffer(b'{"layout": "HWSC"}', "u1")
    for samples_each, taken in ((1, True), (16, False)):
        np.savez_compressed(tmp_path / "a.npz", radiance=np.zeros((512, 512, samples_each, 3), "f4"), meta=meta)
        code, lines, memory, seconds = cost("pack", "--from", "npz", "a.npz", "-o", "out.spool", "--force", cwd=tmp_path)
        assert (code == 0) == taken and (taken or "--max-expansion" in lines[0]), lines
        cheap("npz", memory, seconds)


def test_our_own_files_of_zeros_are_cheap_to_look_at(tmp_path):
    write = dict(tile_size=64, block_spp=1000, compress=True)
    spool.write(tmp_path / "zeros.spool", radiance=np.zeros((64, 128, 1000, 3), "f4"), **write)
    assert (tmp_path / "zeros.spool").stat().st_size < 4096
    for arguments in (("info", "zeros.spool"), ("check", "zeros.spool"), ("recover", "zeros.spool", "saved.spool"),
                      ("reconstruct", "zeros.spool", "--filter", "box", "-o", "box.exr"),
                      ("replay", "zeros.spool", "--sampler", "uniform", "--spp", 4, "-o", "n.exr")):
        code, lines, memory, seconds = cost(*arguments, cwd=tmp_path)
        assert code == 0, lines
        cheap(arguments[0], memory, seconds)


DEEP = hostile_files.nested(200_000)


def test_texts_that_nest_are_refused_at_every_door(tmp_path, small):
    (tmp_path / "flat.exr").write_bytes(hostile_files.deep_exr_with_meta(b'{"a": 1}'))
    assert cost("pack", "--from", "deep-exr", "flat.exr", "-o", "flat.spool", cwd=tmp_path)[:2] == (0, [])
    (tmp_path / "deep.exr").write_bytes(hostile_files.deep_exr_with_meta(b'{"a":' + DEEP + b"}"))
    assert "spoolMeta" in refused("pack", "--from", "deep-exr", "deep.exr", "-o", "out.spool", cwd=tmp_path)

    np.savez(tmp_path / "a.npz", radiance=np.zeros((2, 2, 2, 3), "f4"), meta=np.frombuffer(b'{"a":' + DEEP + b"}", "u1"))
    refused("pack", "--from", "npz", "a.npz", "-o", "out.spool", cwd=tmp_path)

    folder = tmp_path / "recorded.passes"
    folder.mkdir()
    (folder / "manifest.json").write_bytes(b'{"format":"spool-passes","version":1,"recording":{"a":' + DEEP + b"}}")
    (folder / "passes.jsonl").write_bytes(b"")
    assert "manifest.json" in refused("pack", folder, "-o", "out.spool", cwd=tmp_path)
    (folder / "manifest.json").write_bytes(
        b'{"format":"spool-passes","version":1,"recording":{"width":2,"height":2,"mode":"iid","channels":['
        + b",".join(b'{"name":"radiance.%c","dtype":"f32"}' % c for c in b"RGB") + b"]}}")
    (folder / "passes.jsonl").write_bytes(b'{"kind":' + DEEP + b"}\n")
    assert "line 1" in refused("pack", folder, "-o", "out.spool", cwd=tmp_path)

    plan = f'recordings = ["{small}"]\nspp = [1]\nreplicates = 2\nsamplers = ["uniform"]\nfilters = ["box"]\npictures = false\n'
    (tmp_path / "plan.toml").write_text(plan)
    results = tmp_path / "results"
    for name in (None, "manifest.json", "dumps.json"):
        if name:
            (results / name).write_bytes(b'{"runs":[' + DEEP + b"]}")
        code, lines, memory, seconds = cost("evaluate", "plan.toml", "-o", "results", cwd=tmp_path)
        assert code == 0, lines
    for depth in (64, 50_000):
        for text in ("a." * depth + "a = 1", "[" + "a." * depth + "a]", "a = " + "[" * depth + "]" * depth, "a = {" * depth + "}" * depth):
            (tmp_path / "deep.toml").write_text(plan + text + "\n")
            refused("evaluate", "deep.toml", "--dry-run", cwd=tmp_path, codes=(2,))

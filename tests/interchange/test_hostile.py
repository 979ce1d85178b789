"""Every door with files that are cut or damaged: one line, an exit code, no target, no crash."""
import numpy as np
import pytest
import spool

import sample_dumps
import sbmc_files
import test_noisebase
from conftest import run_jobs


def small_files(tmp_path):
    """(door, the file that is damaged, what is imported)"""
    sample_dumps.rich(tmp_path / "a.spool", 1, size=(3, 4), spp=2, finite=True)
    run_jobs(("export deep-exr", tmp_path / "a.spool", tmp_path / "a.exr"), ("export exr-folder", tmp_path / "a.spool", tmp_path / "folder"),
             ("export npz", tmp_path / "a.spool", tmp_path / "a.npz"), ("export bcd", tmp_path / "a.spool", tmp_path / "a.raw"))
    made = sbmc_files.scene(np.random.default_rng(1), 4, 4, 2)
    sbmc_files.write_set(tmp_path / "scene", made, 4)
    test_noisebase.write_store(tmp_path / "a.zip", {name: array for name, array in test_noisebase.sample_set(np.random.default_rng(1), 3, 4, 2).items()
                                                    if name in ("color", "exposure", "normal")})
    return {"deep-exr": (tmp_path / "a.exr",) * 2, "exr-folder": (tmp_path / "folder" / "sample_0001.exr", tmp_path / "folder"),
            "sbmc": (tmp_path / "scene" / "0000_0000.bin", tmp_path / "scene"), "noisebase": (tmp_path / "a.zip",) * 2,
            "npz": (tmp_path / "a.npz",) * 2, "bcd": (tmp_path / "a.raw",) * 2}


@pytest.mark.parametrize("door", ["deep-exr", "exr-folder", "sbmc", "noisebase", "npz", "bcd"])
def test_damage_is_one_line_and_a_code(tmp_path, door):
    damaged, source = small_files(tmp_path)[door]
    whole = damaged.read_bytes()
    target = tmp_path / "out.spool"
    rng = np.random.default_rng(7)
    assert run_jobs((f"import {door}", source, target))[0][0] == 0
    target.unlink()

    def verdict(data):
        damaged.write_bytes(data)
        code, message = run_jobs((f"import {door}", source, target))[0]
        assert code in (0, 1, 2, 3, 4) and (code == 0) == target.exists(), message
        if code != 0:
            assert str(tmp_path) in message and ": " in message
        else:
            assert spool.check(target).ok
            target.unlink()
        assert not any(path.name.endswith((".scratch",)) for path in tmp_path.iterdir())
        (tmp_path / "out.spool.partial").unlink(missing_ok=True)
        return code

    # Cut: never taken for whole.
    for length in sorted({0, 1, 7, 60, 64, len(whole) - 1, *rng.integers(0, len(whole), 20).tolist()}):
        assert verdict(whole[:length]) != 0, length
    # Bits turned: a checksum is not every format's, so the file may be taken; it must not break anything.
    for _ in range(25):
        data = bytearray(whole)
        for _ in range(rng.integers(1, 4)):
            data[rng.integers(0, len(data))] ^= 1 << rng.integers(0, 8)
        verdict(bytes(data))
    # The header of 32-bit fields, each to 0, 1, -1 and the largest.
    for offset in range(0, min(len(whole), 96), 12):
        for value in (b"\0\0\0\0", b"\1\0\0\0", b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f"):
            verdict(whole[:offset] + value + whole[offset + 4 :])

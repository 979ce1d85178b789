"""The golden files of tests/golden, made by a third writer: read as listed, refused by the listed class."""
import json
import pathlib
import zlib

import pytest
import spool

GOLDEN = pathlib.Path(__file__).resolve().parents[1] / "golden"
GOOD = sorted((GOLDEN / "v1.0").glob("*.spool"))
BAD = json.loads((GOLDEN / "must_fail" / "expected.json").read_text())


def test_there_are_enough():
    assert len(GOOD) >= 64 and len(BAD) >= 100


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_golden_file_holds_what_is_listed(path):
    expected = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
    with spool.open(path) as dump:
        for name in ("width", "height", "tile_size", "spp", "block_spp"):
            assert getattr(dump, name) == expected[name]
        assert dump.sample_order == ("renderer", "exchangeable")[expected["sample_order"]]
        assert dump.uuid.hex == expected["uuid"]
        assert [(c.name, c.group, c.semantic) for c in dump.channels] == [
            (name, group, semantic) for name, group, _, semantic, _ in expected["channels"]]
        assert [c.dtype.str for c in dump.channels] == [(None, "<f2", "<f4", "<u4")[c[2]] for c in expected["channels"]]
        assert [c.scope for c in dump.channels] == [("sample", "pixel", "pass")[c[4]] for c in expected["channels"]]
        assert dump.complete == expected["complete"]
        assert list(dump.meta_records) == expected["meta"]
        merged = {}
        for text in expected["meta"]:
            merged.update(json.loads(text))
        assert dump.meta == merged
        assert dump.record_count == expected["records"]
        assert len(dump.blocks()) == len(expected["blocks"])
        for block in expected["blocks"]:
            raw = dump.block(block["group"], block["tile"], block["sample_begin"]).tobytes()
            assert (len(raw), zlib.crc32(raw)) == (block["bytes"], block["crc32"])
    assert spool.check(path).ok


@pytest.mark.parametrize("name", BAD)
def test_bad_file_is_refused_by_its_class(name):
    path = GOLDEN / "must_fail" / f"{name}.spool"
    try:
        spool.open(path).close()
        opens, kind = True, None
    except spool.SpoolError as reason:
        opens, kind = False, reason.kind
    report = spool.check(path)
    assert opens == BAD[name]["opens"]
    assert not report.ok
    assert {error.kind for error in report.errors} == {BAD[name]["class"]}
    assert opens or kind == BAD[name]["class"]

"""Files whose CRCs are all right and whose contents are not: each lie has its class of failure."""
import zlib

import numpy as np
import pytest
import spool
from spool import record_layout as layout

from container import Container
from sample_files import tiny


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    return Container(tiny(tmp_path_factory.mktemp("lies") / "good.spool"))


def kind_of(container, tmp_path):
    path = tmp_path / "lie.spool"
    path.write_bytes(container.build())
    report = spool.check(path)
    return report.errors[0].kind if report.errors else None


def payload_lie(good, row, dtype, field, value, entry=0):
    lie = good.copy()
    table = np.frombuffer(lie.records[row][1], dtype).copy()
    table[entry][field] = value
    lie.records[row][1] = table.tobytes()
    return lie


def test_rebuilt_file_is_the_file(good, tmp_path):
    assert good.build() == tiny(tmp_path / "again.spool") and kind_of(good, tmp_path) is None


@pytest.mark.parametrize("field, value, kind", [
    ("major", 0, "unsupported"), ("major", 2, "unsupported"), ("minor", 1, None), ("required_features", 1, "unsupported"),
    ("required_features", 1 << 31, "unsupported"), ("reserved", np.void(b"\1" * 28), "invalid"),
    ("magic", np.void(b"\x89SPM\r\n\x1a\n"), "not_spool")])
def test_file_header(good, tmp_path, field, value, kind):
    lie = good.copy()
    lie.head[field] = value
    assert kind_of(lie, tmp_path) == kind


def test_unknown_feature_bit_is_named(good, tmp_path):
    lie = good.copy()
    lie.head["required_features"] = 0b101000
    path = tmp_path / "feature.spool"
    path.write_bytes(lie.build())
    with pytest.raises(spool.SpoolError, match="feature bit 3 "):
        spool.open(path)


@pytest.mark.parametrize("field, value, kind", [
    ("index_offset", 0, "damaged"), ("index_offset", 64, "damaged"), ("index_offset", 2**64 - 64, "damaged"),
    ("file_bytes", 0, "damaged"), ("file_bytes", 2**64 - 1, "damaged"), ("record_count", 0, "damaged"),
    ("record_count", 2, "damaged"), ("record_count", 2**20 + 1, "damaged"), ("record_count", 2**63, "damaged"),
    ("dump_id", 1, "damaged"), ("data_record_count", 0, "damaged"), ("data_record_count", 2**64 - 1, "damaged"),
    ("flags", 0, "damaged"), ("flags", 3, "damaged"), ("flags", 1 << 31, "damaged"),
    ("reserved", np.void(b"\0" * 7 + b"\1"), "damaged"), ("end_magic", np.void(b"SPLEND\n\n"), "incomplete")])
def test_footer(good, tmp_path, field, value, kind):
    lie = good.copy()

    def change(entries, header, foot):
        foot[field] = value
    lie.lie_in_index = change
    assert kind_of(lie, tmp_path) == kind


@pytest.mark.parametrize("field, value", [
    ("sync", np.void(b"\x9eREX")), ("type", np.void(b"DATA")), ("sequence", 0), ("dump_id", 0), ("stored_bytes", 64),
    ("raw_bytes", 64), ("payload_crc32", 0), ("codec", 1), ("filter", 1), ("group", 1), ("tile", 1), ("sample_begin", 1),
    ("sample_count", 1)])
def test_index_header(good, tmp_path, field, value):
    lie = good.copy()

    def change(entries, header, foot):
        header[field] = value
    lie.lie_in_index = change
    assert kind_of(lie, tmp_path) == "damaged"


@pytest.mark.parametrize("field", layout.INDEX_ENTRY.names)
def test_index_entry_must_equal_its_header(good, tmp_path, field):
    lie = good.copy()

    def change(entries, header, foot):
        entries[3][field] = np.void(b"meta") if field == "type" else int(entries[3][field]) ^ 1
        header["payload_crc32"] = zlib.crc32(entries.tobytes())
    lie.lie_in_index = change
    assert kind_of(lie, tmp_path) == "damaged"


@pytest.mark.parametrize("field, value, kind", [
    ("sync", np.void(b"\0\0\0\0"), "damaged"), ("type", np.void(b"DAT1"), "damaged"), ("type", np.void(b"DATB"), "unsupported"),
    ("type", np.void(b"IMAG"), "damaged"), ("type", np.void(b"INDX"), "damaged"), ("type", np.void(b"dATA"), "damaged"),
    ("sequence", 0, "damaged"), ("sequence", 2**64 - 1, "damaged"), ("dump_id", 0, "damaged"), ("stored_bytes", 0, "damaged"),
    ("stored_bytes", 2**63, "damaged"), ("stored_bytes", 2**26 + 64, "damaged"), ("raw_bytes", 0, "damaged"),
    ("raw_bytes", 2**64 - 1, "damaged"), ("raw_bytes", 2**26 + 1, "damaged"), ("codec", 1, "damaged"), ("codec", 2, "unsupported"),
    ("codec", 255, "unsupported"), ("filter", 1, "damaged"), ("filter", 2, "unsupported"), ("group", 3, "damaged"),
    ("group", 65535, "damaged"), ("tile", 2, "damaged"), ("tile", 2**32 - 1, "damaged"), ("tile", 1, "damaged"),
    ("sample_begin", 1, "damaged"), ("sample_begin", 2, "damaged"), ("sample_begin", 2**32 - 2, "damaged"),
    ("sample_count", 0, "damaged"), ("sample_count", 1, "damaged"), ("sample_count", 2**32 - 1, "damaged")])
def test_data_header(good, tmp_path, field, value, kind):
    lie = good.copy()
    lie.records[3][0][field] = value
    assert kind_of(lie, tmp_path) == kind


@pytest.mark.parametrize("unknown, damaged, kind", [(3, 4, "unsupported"), (4, 3, "damaged")])
@pytest.mark.parametrize("field, value", [("dump_id", 0), ("sequence", 99), ("stored_bytes", 2**26 + 64)])
def test_the_first_record_with_a_fault_decides(good, tmp_path, unknown, damaged, kind, field, value):
    lie = good.copy()
    lie.records[unknown][0]["codec"] = 2
    lie.records[damaged][0][field] = value
    assert kind_of(lie, tmp_path) == kind


@pytest.mark.parametrize("row", [0, 1, 2])
@pytest.mark.parametrize("field, kind", [("codec", "damaged"), ("filter", "damaged"), ("group", "damaged"), ("tile", "damaged"),
                                         ("sample_begin", "damaged"), ("sample_count", "damaged")])
def test_header_of_other_records(good, tmp_path, row, field, kind):
    lie = good.copy()
    lie.records[row][0][field] = 1
    assert kind_of(lie, tmp_path) == kind


@pytest.mark.parametrize("field, value", [
    ("width", 0), ("width", 65537), ("width", 2**32 - 1), ("height", 0), ("height", 65537), ("tile_size", 0), ("tile_size", 4),
    ("tile_size", 12), ("tile_size", 512), ("tile_size", 2**31), ("spp", 0), ("spp", 65537), ("block_spp", 0), ("block_spp", 1025),
    ("group_count", 0), ("group_count", 2), ("group_count", 4), ("group_count", 17), ("channel_count", 0), ("channel_count", 65),
    ("pixel_filter", 1), ("colour_space", 1), ("sample_order", 2), ("reserved", np.void(b"\1" * 24))])
def test_geometry(good, tmp_path, field, value):
    assert kind_of(payload_lie(good, 0, layout.IMAG, field, value), tmp_path) == "invalid"


@pytest.mark.parametrize("changes", [{"width": 65536, "height": 65536}, {"width": 65536, "height": 4096, "spp": 65536},
                                     {"tile_size": 256, "width": 256, "height": 256, "spp": 1024, "block_spp": 1024}])
def test_bombs_of_geometry_cost_nothing(good, tmp_path, changes):
    lie = good
    for field, value in changes.items():
        lie = payload_lie(lie, 0, layout.IMAG, field, value)
    assert kind_of(lie, tmp_path) == "invalid"


@pytest.mark.parametrize("changes, kind", [({"width": 10}, "damaged"), ({"height": 9}, "damaged"), ({"spp": 4}, "damaged"),
                                           ({"spp": 5}, "damaged"), ({"block_spp": 4}, "damaged"), ({"tile_size": 16}, "damaged")])
def test_other_geometry_does_not_fit_the_blocks(good, tmp_path, changes, kind):
    lie = good
    for field, value in changes.items():
        lie = payload_lie(lie, 0, layout.IMAG, field, value)
    assert kind_of(lie, tmp_path) == kind


@pytest.mark.parametrize("entry, field, value, kind", [
    (0, "name", b"radiance.G", "invalid"), (0, "name", b"Radiance.R", "invalid"), (0, "name", b"radiance", "invalid"),
    (0, "name", b"radiance.R\0x", "invalid"), (0, "name", b"radiance.R.R", "invalid"), (0, "name", b"r" * 30 + b".R", "invalid"),
    (3, "name", b"film.X\n", "invalid"), (3, "name", b"1film.X", "invalid"), (3, "name", b"film.1", "invalid"),
    (3, "name", b"film.\xff", "invalid"), (3, "name", b"other.X", None), (4, "name", b"film.X", "invalid"),
    (4, "name", b"reference.Q", "invalid"), (6, "name", b"split.G", "invalid"),
    (0, "group", 1, "invalid"), (3, "group", 0, "invalid"), (3, "group", 2, "invalid"), (7, "group", 3, "invalid"),
    (0, "dtype", 0, "invalid"), (0, "dtype", 1, "invalid"), (3, "dtype", 4, "invalid"), (0, "scope", 1, "invalid"),
    (3, "scope", 3, "invalid"), (3, "semantic", 10, "invalid"), (3, "semantic", 9, None), (3, "reserved", b"\1", "invalid")])
def test_channels(good, tmp_path, entry, field, value, kind):
    if isinstance(value, bytes):
        value = np.void(value.ljust(layout.CHAN.fields[field][0].itemsize, b"\0"))
    assert kind_of(payload_lie(good, 1, layout.CHAN, field, value, entry), tmp_path) == kind


def test_newer_minor_ignores_what_it_may_not_know(good, tmp_path):
    lie = payload_lie(good, 1, layout.CHAN, "semantic", 4711)
    lie = payload_lie(lie, 0, layout.IMAG, "reserved", np.void(b"\1" * 24))
    lie.head["reserved"] = np.void(b"\1" * 28)
    assert kind_of(lie, tmp_path) == "invalid"
    lie.head["minor"] = 1
    path = tmp_path / "newer.spool"
    path.write_bytes(lie.build())
    with spool.open(path) as dump:
        assert dump.channels[0].semantic == 0


def test_repeated_and_missing_records(good, tmp_path):
    lie = good.copy()
    lie.records.insert(4, [record.copy() if isinstance(record, np.void) else record for record in lie.records[3]])
    lie.renumber()
    assert kind_of(lie, tmp_path) == "damaged"
    for row, kind in ((0, "damaged"), (1, "damaged"), (2, None), (3, "damaged")):  # without a block flag 0 is a lie
        lie = good.copy()
        del lie.records[row]
        lie.renumber()
        assert kind_of(lie, tmp_path) == kind
    lie = good.copy()
    lie.records[0], lie.records[1] = lie.records[1], lie.records[0]
    lie.renumber()
    assert kind_of(lie, tmp_path) == "damaged"


def test_ancillary_records(good, tmp_path):
    for type, payload, kind in ((b"xpix", b"?", None), (b"note", b"?" * 100, None), (b"Note", b"?", "unsupported"),
                                (b"no e", b"?", "damaged"), (b"meta", b"{", "damaged"), (b"meta", b"{}", None)):
        lie = good.copy()
        lie.insert(3, type, payload)
        assert kind_of(lie, tmp_path) == kind, type
    lie = good.copy()
    for _ in range(63):
        lie.insert(2, b"meta", b"{}")
    assert kind_of(lie, tmp_path) is None
    lie.insert(2, b"meta", b"{}")
    assert kind_of(lie, tmp_path) == "damaged"


def test_pad_bytes_are_checked(good, tmp_path):
    data = bytearray(good.build())
    at = data.index(b"meta") - 4
    stored = int.from_bytes(data[at + 24:at + 32], "little")
    data[at + 64 + stored] = 1
    path = tmp_path / "pad.spool"
    path.write_bytes(data)
    assert spool.check(path).errors[0].kind == "damaged"

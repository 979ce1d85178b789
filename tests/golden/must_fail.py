#!/usr/bin/env python3
"""Writes must_fail/*.spool and must_fail/expected.json: files that a reader must refuse, and by which class.

    python3 tests/golden/must_fail.py           # only files that do not exist yet
Every checksum is right unless the case is about it. "opens": the file opens, and only checking it finds the damage.
"""
import copy
import json
import pathlib
import struct

import zstandard

from container import Record
from dump import F16, Dump, all_groups, radiance

HERE = pathlib.Path(__file__).parent / "must_fail"
META = ('{"a":1}',)


def dump():
    return Dump(9, 3, spp=3, channels=radiance() + [("film.X", 1, 2, 6, 2), ("film.Y", 1, 2, 6, 2)])


def base(codec="none"):
    return dump().container(codec, META)


def packed(data, **options):
    settings = dict(write_checksum=True, write_content_size=True)
    settings.update(options)
    return zstandard.ZstdCompressor(level=3, **settings).compress(data)


def patch(payload, offset, format, value):
    size = struct.calcsize("<" + format)
    return payload[:offset] + struct.pack("<" + format, value) + payload[offset + size:]


CASES = {}


def case(name, failure, opens=False, codec="none"):
    """Registers a function that turns a good container into a bad one; it may return bytes instead."""
    def register(change):
        container = base(codec)
        CASES[name] = (failure, opens, change(container) or container.build())
        return change
    return register


def on_field(name, failure, record, offset, format, *values):
    """One case per value of a field of IMAG (record 0) or CHAN (record 1)."""
    for value in values:
        @case(f"{name}_{value}".replace("-", "minus"), failure)
        def change(c, value=value):
            c.records[record].payload = patch(c.records[record].payload, offset, format, value)


def on_record(name, failure, number, **fields):
    @case(name, failure)
    def change(c):
        for field, value in fields.items():
            setattr(c.records[number], field, value)


def on_footer(name, failure, **fields):
    @case(name, failure)
    def change(c):
        c.lie_in_footer = lambda footer: footer.update(fields)


def whole_file():
    good = base().build()
    half = good[:len(good) // 2]
    for name, failure, data in (
            ("empty", "incomplete", b""), ("three_bytes_of_magic", "incomplete", good[:3]),
            ("header_only", "incomplete", good[:64]), ("cut_in_header", "incomplete", good[:40]),
            ("cut_in_half", "incomplete", half), ("no_footer", "incomplete", good[:-64]),
            ("cut_in_footer", "incomplete", good[:-1]), ("one_byte_more", "incomplete", good + b"\0"),
            ("twice", "damaged", good + good), ("text", "not_spool", b"This is a text, and nothing else.\n" * 8),
            ("png", "not_spool", b"\x89PNG\r\n\x1a\n" + bytes(200)), ("zeros", "not_spool", bytes(4096)),
            ("line_ends_unix", "damaged", good.replace(b"\r\n", b"\n")),
            ("line_ends_doubled", "damaged", good.replace(b"\n", b"\r\n")),
            ("first_byte_stripped", "damaged", b"\x09" + good[1:]), ("header_bit", "damaged", good[:20] + b"\xff" + good[21:]),
            ("header_crc_zero", "damaged", good[:60] + bytes(4) + good[64:]),
            ("footer_crc_zero", "damaged", good[:-4] + bytes(4)),
            ("record_gap", "damaged", good[:64] + bytes(64) + good[64:]),
            ("record_missing", "damaged", good[:320 + 64] + good[320 + 192:])):
        CASES[name] = (failure, False, data)


def file_header():
    for name, failure, fields in (
            ("major_0", "unsupported", dict(major=0)), ("major_2", "unsupported", dict(major=2)),
            ("major_65535", "unsupported", dict(major=65535)), ("feature_bit_0", "unsupported", dict(features=1)),
            ("feature_bit_31", "unsupported", dict(features=1 << 31)),
            ("header_reserved_first", "invalid", dict(reserved=b"\1" + bytes(27))),
            ("header_reserved_last", "invalid", dict(reserved=bytes(27) + b"\1"))):
        @case(name, failure)
        def change(c, fields=fields):
            for field, value in fields.items():
                setattr(c, field, value)

    @case("uuid_of_another_dump", "damaged")
    def change(c):
        for record in c.records + [c.index]:
            record.dump_id = 5


def geometry():
    on_field("width", "invalid", 0, 0, "I", 0, 65537, 2**32 - 1)
    on_field("height", "invalid", 0, 4, "I", 0, 65537)
    on_field("tile_size", "invalid", 0, 8, "I", 0, 4, 24, 512)
    on_field("spp", "invalid", 0, 12, "I", 0, 65537)
    on_field("block_spp", "invalid", 0, 16, "I", 0, 1025)
    on_field("group_count", "invalid", 0, 20, "I", 0, 1, 3, 17)
    on_field("channel_count", "invalid", 0, 24, "I", 0, 4, 6, 65)
    on_field("pixel_filter", "invalid", 0, 28, "I", 1)
    on_field("colour_space", "invalid", 0, 32, "I", 1)
    on_field("sample_order", "invalid", 0, 36, "I", 2)
    on_field("imag_reserved", "invalid", 0, 40, "B", 1)
    on_field("imag_reserved_end", "invalid", 0, 63, "B", 1)
    on_field("narrower", "damaged", 0, 0, "I", 8)
    on_field("more_samples", "damaged", 0, 12, "I", 4)

    def sized(name, *words):
        @case(name, "invalid")
        def change(c):
            c.records[0].payload = struct.pack(f"<{len(words)}I", *words) + c.records[0].payload[4 * len(words):]
    sized("too_many_pixels", 65536, 65536, 256)
    sized("too_many_blocks", 16384, 16384, 8, 4, 1)
    sized("block_too_large", 256, 256, 256, 1024, 1024)


def channels():
    chan = 192  # entry of film.X
    for name, text in (("no_dot", b"film"), ("two_dots", b"film.x.y"), ("upper_case_layer", b"Film.X"),
                       ("empty_layer", b".X"), ("empty_component", b"film."), ("space", b"film .X"), ("empty_name", b""),
                       ("digit_first", b"1film.X"), ("not_ascii", b"f\xc3\xa4.X"), ("component_digit", b"film.1"),
                       ("repeated_name", b"film.Y"), ("layer_of_another_group", b"radiance.X"),
                       ("bytes_after_nul", b"film.X\0x"), ("no_nul", b"f" * 30 + b".X")):
        @case("name_" + name, "invalid")
        def change(c, text=text):
            c.records[1].payload = c.records[1].payload[:chan] + text.ljust(32, b"\0") + c.records[1].payload[chan + 32:]
    on_field("first_group", "invalid", 1, 32, "H", 1)
    on_field("group_jump", "invalid", 1, chan + 32, "H", 2)
    on_field("dtype", "invalid", 1, chan + 34, "H", 0, 4)
    on_field("dtype_differs_in_group", "invalid", 1, chan + 34, "H", 1)
    on_field("semantic", "invalid", 1, chan + 36, "H", 10)
    on_field("scope", "invalid", 1, chan + 38, "H", 3)
    on_field("scope_differs_in_group", "invalid", 1, chan + 38, "H", 0)
    on_field("chan_reserved", "invalid", 1, chan + 40, "B", 1)

    @case("radiance_not_first", "invalid")
    def change(c):
        c.records[1].payload = c.records[1].payload.replace(b"radiance.G", b"radiance.H")

    @case("radiance_u32", "invalid")
    def change(c):
        for entry in range(3):
            c.records[1].payload = patch(c.records[1].payload, 64 * entry + 34, "H", 3)

    @case("radiance_pixel_scope", "invalid")
    def change(c):
        for entry in range(3):
            c.records[1].payload = patch(c.records[1].payload, 64 * entry + 38, "H", 1)

    @case("alpha_in_group_0", "invalid")
    def change(c):
        more = Dump(9, 3, channels=radiance() + [("alpha.A", 0, 2, 0, 0)])
        c.records[:2] = [more.imag(), more.chan()]

    @case("chan_65", "damaged")
    def change(c):
        c.records[1].payload = bytes(64 * 65)


def records():
    on_record("sync_wrong", "damaged", 3, sync=b"\x9eRED")
    on_record("sequence_gap", "damaged", 3, sequence=9)
    on_record("foreign_record", "damaged", 3, dump_id=1)
    on_record("type_digits", "damaged", 2, type=b"me7a")
    on_record("critical_unknown", "unsupported", 2, type=b"META")
    on_record("codec_2", "unsupported", 3, codec=2)
    on_record("filter_2", "unsupported", 3, filter=2)
    on_record("filter_without_codec", "damaged", 3, filter=1)
    on_record("codec_on_meta", "damaged", 2, codec=1, raw=100)
    on_record("group_on_meta", "damaged", 2, group=1)
    on_record("samples_on_imag", "damaged", 0, count=1)
    on_record("raw_not_stored", "damaged", 3, raw=10**6)
    on_record("raw_above_limit", "damaged", 3, raw=2**26 + 1, codec=1)
    on_record("raw_huge", "damaged", 3, raw=2**64 - 1)
    on_record("stored_huge", "damaged", 3, stored=2**64 - 1, raw=2**64 - 1)
    on_record("stored_zero", "damaged", 2, stored=0, raw=0)
    on_record("group_unknown", "damaged", 3, group=2)
    on_record("tile_outside", "damaged", 3, tile=2)
    on_record("tile_of_pass", "damaged", 7, tile=1)
    on_record("samples_between_blocks", "damaged", 3, begin=1)
    on_record("samples_outside", "damaged", 3, begin=4)
    on_record("count_short", "damaged", 3, count=1)
    on_record("count_zero", "damaged", 3, count=0)
    on_record("imag_as_meta", "damaged", 0, type=b"meta")
    on_record("meta_as_indx", "damaged", 2, type=b"INDX")
    for name, change in {
            "block_twice": lambda c: c.records.insert(4, copy.copy(c.records[3])),
            "imag_twice": lambda c: c.records.insert(2, c.records[0]),
            "chan_first": lambda c: c.records.insert(0, c.records.pop(1)),
            "no_chan": lambda c: c.records.pop(1) and None,
            "imag_long": lambda c: setattr(c.records[0], "payload", c.records[0].payload + bytes(64)),
            "block_absent_flag_set": lambda c: c.records.pop(3) and None,
            "block_too_short": lambda c: (setattr(c.records[3], "payload", c.records[3].payload[:-4]),
                                          setattr(c.records[3], "raw", None)) and None,
            "meta_65": lambda c: c.records.extend(Record(b"meta", b"{}") for _ in range(64))}.items():
        case(name, "damaged")(change)


def index_and_footer():
    def entry(name, offset, format, value):
        @case(name, "damaged")
        def change(c):
            c.lie_in_entries = lambda entries: entries.__setitem__(3, patch(entries[3], offset, format, value))
    entry("entry_offset", 0, "Q", 64)
    entry("entry_offset_huge", 0, "Q", 2**64 - 64)
    entry("entry_type", 8, "4s", b"meta")
    entry("entry_crc", 44, "I", 1)
    entry("entry_stored", 28, "Q", 64)
    for name, fields in (("index_type", dict(type=b"INDY")), ("index_sequence", dict(sequence=1)),
                         ("index_codec", dict(codec=1)), ("index_stored", dict(stored=64, raw=64)),
                         ("index_crc", dict(crc=1)), ("index_sync", dict(sync=bytes(4)))):
        @case(name, "damaged")
        def change(c, fields=fields):
            for field, value in fields.items():
                setattr(c.index, field, value)
    on_footer("index_offset_zero", "damaged", index_offset=0)
    on_footer("index_offset_huge", "damaged", index_offset=2**64 - 64)
    on_footer("file_bytes_wrong", "damaged", file_bytes=64)
    on_footer("records_2", "damaged", records=2)
    on_footer("records_huge", "damaged", records=2**20 + 1)
    on_footer("records_wrap", "damaged", records=2**58 + 9)
    on_footer("footer_of_another_dump", "damaged", dump_id=1)
    on_footer("data_records_wrong", "damaged", data=4)
    on_footer("flag_unknown", "damaged", flags=3)
    on_footer("flag_clear", "damaged", flags=0)
    on_footer("footer_reserved", "damaged", reserved=b"\0\0\0\0\0\0\0\1")
    on_footer("end_magic", "incomplete", end=b"SPLEND\n\r")


def metas():
    for name, text in (("array", b"[1]"), ("space_first", b" {}"), ("bom", b"\xef\xbb\xbf{}"), ("two", b"{} {}"),
                       ("nan", b'{"a":NaN}'), ("overflow", b'{"a":1e999}'), ("latin1", b'{"a":"\xe4"}'), ("one_byte", b"{"),
                       ("surrogate", b'{"a":"\\ud800"}'), ("comma", b'{"a":1,}'), ("nul", b"{}\0"), ("cut", b'{"a":'),
                       ("deep", b'{"a":' + b"[" * 64 + b"]" * 64 + b"}"), ("control", b'{"a":"\n"}')):
        @case("meta_" + name, "damaged")
        def change(c, text=text):
            c.records[2].payload = text


def payloads():
    """Damage that only checking, or reading the block, finds."""
    def payload(name, codec, make):
        @case(name, "damaged", opens=True, codec=codec)
        def change(c):
            record = c.records[3]
            record.payload = make(record, dump().raw((record.group, record.tile, record.begin, record.count)))
            assert len(record.payload) < record.raw
    def descriptor(frame, set_bits):
        return frame[:4] + bytes([frame[4] | set_bits]) + frame[5:]
    payload("zstd_no_checksum", "zstd", lambda r, raw: packed(raw, write_checksum=False))
    payload("zstd_no_content_size", "zstd", lambda r, raw: packed(raw, write_content_size=False))
    payload("zstd_decodes_short", "zstd", lambda r, raw: packed(raw[:-4]))
    payload("zstd_decodes_long", "zstd", lambda r, raw: packed(raw + bytes(4)))
    payload("zstd_two_frames", "zstd", lambda r, raw: packed(raw[:400]) + packed(raw[400:]))
    payload("zstd_byte_behind", "zstd", lambda r, raw: r.payload + b"\0")
    payload("zstd_cut", "zstd", lambda r, raw: r.payload[:-5])
    payload("zstd_content_damaged", "zstd", lambda r, raw: packed(bytes(len(raw)))[:-4] + r.payload[-4:])
    payload("zstd_skippable", "zstd", lambda r, raw: b"\x50\x2a\x4d\x18" + bytes(4) + r.payload)
    payload("zstd_dictionary_id", "zstd", lambda r, raw: descriptor(r.payload, 1)[:6] + b"\7" + r.payload[6:])
    payload("zstd_no_frame", "zstd", lambda r, raw: b"no zstd frame at all")

    @case("payload_bit", "damaged", opens=True)
    def change(c):
        c.records[3].crc = 12345

    @case("pad_not_zero", "damaged", opens=True)
    def change(c):
        last = c.records[-1]
        last.pad = b"\0" * (-len(last.payload) % 64 - 1) + b"\1"


def main():
    for make in (whole_file, file_header, geometry, channels, records, index_and_footer, metas, payloads):
        make()
    HERE.mkdir(exist_ok=True)
    for name, (_, _, data) in CASES.items():
        target = HERE / f"{name}.spool"
        if not target.exists():
            target.write_bytes(data)
    listing = {name: {"class": failure, "opens": opens} for name, (failure, opens, _) in sorted(CASES.items())}
    (HERE / "expected.json").write_text(json.dumps(listing, indent=1) + "\n")


if __name__ == "__main__":
    main()

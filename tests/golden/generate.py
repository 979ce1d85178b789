#!/usr/bin/env python3
"""Writes the golden files v1.0/*.spool with their expected values, one per combination of features.

    python3 tests/golden/generate.py            # only files that do not exist yet
Golden files are never edited and never made again: a later version of the format must read them as they are.
"""
import itertools
import json
import pathlib

from dump import F16, F32, PASS, PIXEL, SAMPLE, U32, Dump, all_groups, radiance

HERE = pathlib.Path(__file__).parent / "v1.0"
META = ('{"renderer":{"name":"golden","version":"1"},"seed":7}',)


def combinations():
    for codec, dtype, edge, groups, partial in itertools.product(
            ("none", "zstd", "zstd-shuffle"), (F32, F16), (False, True), (False, True), (False, True)):
        width, height, spp = (9, 5, 3) if edge else (8, 8, 4)
        dump = Dump(width, height, spp=spp, channels=all_groups(dtype) if groups else radiance(dtype))
        keys = list(dump.keys())
        kept = [key for number, key in enumerate(keys) if number % 3 != 1] if partial else keys
        name = "_".join([codec, "f16" if dtype == F16 else "f32", "edge" if edge else "whole",
                         "groups" if groups else "radiance", "partial" if partial else "complete"])
        yield name, dump, dump.container(codec, META, kept)


def shapes():
    for name, fields in {
            "one_pixel": dict(width=1, height=1, spp=1, block_spp=1), "wide": dict(width=65, height=1, spp=1, block_spp=1),
            "tall": dict(width=1, height=65, spp=1, block_spp=1), "tile_larger_than_image": dict(tile_size=256),
            "tile_16": dict(width=17, height=16, tile_size=16, spp=1), "block_larger_than_spp": dict(block_spp=1024),
            "block_of_one": dict(block_spp=1), "renderer_order": dict(sample_order=0),
            "special_f32": dict(special=True), "special_f16": dict(special=True, channels=all_groups(F16)),
            "channels_64": dict(width=2, height=2, spp=1, channels=radiance() + [
                (f"aux_{n}.V", 1, F16, 0, SAMPLE) for n in range(61)]),
            "groups_16": dict(width=2, height=2, spp=2, block_spp=1, channels=radiance() + [
                (f"aux_{n}.V", n, (F16, F32, U32)[n % 3], n % 10, (SAMPLE, PIXEL, PASS)[n % 3]) for n in range(1, 16)]),
            "longest_name": dict(channels=radiance() + [("a2345678901234567890123456789.V", 1, F32, 0, SAMPLE)]),
    }.items():
        dump = Dump(**fields)
        yield name, dump, dump.container(meta=META)
    dump = Dump(special=True)
    yield "special_f32_zstd", dump, dump.container("zstd-shuffle")


def orders_and_extras():
    dump = Dump(17, 9, spp=4, block_spp=1, channels=all_groups())
    keys = list(dump.keys())
    yield "pass_by_pass", dump, dump.container("zstd-shuffle", keys=sorted(keys, key=lambda k: (k[2], k[0], k[1])))
    yield "backwards", dump, dump.container("zstd-shuffle", keys=keys[::-1])
    mixed = ("none", "zstd", "zstd-shuffle")
    yield "mixed_codecs", dump, dump.container(lambda number: mixed[number % 3])
    dump = Dump()
    yield "no_samples", dump, dump.container(keys=[])
    yield "no_meta", dump, dump.container()
    yield "meta_override", dump, dump.container(meta=('{"a":1,"b":{"x":1,"y":2}}', '{"b":{"x":3},"c":[]}'))
    yield "meta_unicode", dump, dump.container(meta=('{"scene":"\u00e4\u4e2d\U0001F600","escaped":"\\ud83d\\ude00\\n"}',))
    yield "meta_empty", dump, dump.container(meta=("{}",))
    yield "meta_deepest", dump, dump.container(meta=('{"a":' + "[" * 63 + "]" * 63 + "}",))
    yield "meta_64", dump, dump.container(meta=tuple('{"n":%d}' % n for n in range(64)))
    with_private = dump.container(meta=META)
    from container import Record
    with_private.records.insert(2, Record(b"xYzw", b"anything at all"))
    with_private.records.append(Record(b"note", b"\0" * 64))
    yield "unknown_ancillary", dump, with_private
    later = dump.container(meta=META)
    later.minor, later.reserved = 7, bytes(range(28))
    later.records[0].payload = later.records[0].payload[:40] + b"\x01" * 24
    later.records[1].payload = later.records[1].payload[:40] + b"\x02" * 24 + later.records[1].payload[64:]
    later.lie_in_footer = lambda footer: footer.update(flags=footer["flags"] | 0x80, reserved=b"\x03" * 8)
    yield "later_minor", dump, later


def main():
    HERE.mkdir(exist_ok=True)
    for name, dump, container in itertools.chain(combinations(), shapes(), orders_and_extras()):
        target = HERE / f"{name}.spool"
        if target.exists():
            continue
        target.write_bytes(container.build())
        text = json.dumps(dump.expected(container), indent=1, ensure_ascii=False)
        target.with_suffix(".json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

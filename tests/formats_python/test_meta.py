import os

import numpy as np
import pytest
import spool
from spool import meta


@pytest.mark.parametrize("text", [
    "{}", '{"a":"[[\\"[[\\\\","a":{"b":"' + "[" * 99 + '"}}',
    '{"a":1.5e300,"b":[true,false,null,"\u00e4\\n\\ud83d\\ude00"]}', '{"a":1}\n ', '{"a":' + "[" * 63 + "]" * 63 + "}"])
def test_json_objects_pass(text):
    assert isinstance(meta.decode(text.encode()), dict)


@pytest.mark.parametrize("payload", [
    b"", b"{", b"[]", b" {}", b"\xef\xbb\xbf{}", b"{}x", b"{'a':1}", b'{"a":NaN}', b'{"a":-Infinity}', b'{"a":1e999}',
    b'{"a":' + b"9" * 400 + b"}", b'{"a":"\xff"}', b'{"a":"\\ud800"}', b'{"\\udc00":1}', b'{"a":01}', b'{"a":1,}', b'{"a"}',
    b'{"a":"\n"}', b'{"a":' + b"[" * 64 + b"]" * 64 + b"}", b'{"a":' + b"[" * 100000 + b"]" * 100000 + b"}",
    b'{"a":"' + b"x" * (1 << 20) + b'"}', b'{"a":"\\ud800","a":1}', b'{"a":["\\ud800"],"a":1}', b'{"a":{"\\udc00":1},"a":1}',
    b'{"b":[{"a":["\\ud800"],"a":1}]}', b'{"a":' + b"[" * 64 + b"]" * 64 + b',"a":1}'])
def test_anything_else_is_damage(payload):
    with pytest.raises(spool.SpoolError) as caught:
        meta.decode(payload)
    assert caught.value.kind == "damaged" and len(str(caught.value)) < 200


def test_records_combine_by_top_level_key_in_file_order(tmp_path):
    path = tmp_path / "meta.spool"
    with spool.Writer(path, 1, 1, 1, {"radiance": ("f4", "RGB")}, meta={"a": {"x": 1}, "b": 1}) as writer:
        writer.write_meta('{"a": {"y": 2}}')
    with spool.open(path) as dump:
        assert dump.meta == {"a": {"y": 2}, "b": 1}
        assert dump.meta_records == ['{"a":{"x":1},"b":1}', '{"a": {"y": 2}}']


@pytest.mark.parametrize("value", [{"a": float("nan")}, {"a": object()}, "[]", {"a": "\ud800"}, {"a": 10**400},
                                   '{"a":"\\ud800","a":1}',
                                   '{"a":' + "[" * 64 + "]" * 64 + ',"a":1}'])
def test_writer_refuses_what_the_reader_would(tmp_path, value):
    with pytest.raises(spool.SpoolError) as caught:
        spool.Writer(tmp_path / "meta.spool", 1, 1, 1, {"radiance": ("f4", "RGB")}, meta=value)
    assert caught.value.kind == "usage"
    assert not list(tmp_path.iterdir())


def written(path, **more):
    with spool.Writer(path, 3, 2, 2, {"radiance": ("f4", "RGB")}, meta={"a": 1, "b": 2}, **more) as writer:
        writer.write_passes(0, {"radiance": np.arange(36, dtype="f4").reshape(2, 3, 2, 3)})
    return path


@pytest.mark.parametrize("compress", [False, True])
def test_a_record_is_added_in_place_and_moves_no_block(tmp_path, compress):
    path = written(tmp_path / "a.spool", compress=compress)
    before = path.read_bytes()
    for value in (3, 4):
        spool.append_meta(path, {"b": value})
    assert spool.check(path).ok
    with spool.open(path) as dump:
        assert dump.meta == {"a": 1, "b": 4} and len(dump.meta_records) == 3 and dump.read("radiance").sum() == 35 * 18
        assert path.read_bytes()[:int(dump.index[-2]["offset"])] == before[:int(dump.index[-2]["offset"])]


def test_what_cannot_be_added_leaves_the_file_as_it_was(tmp_path, monkeypatch):
    path = written(tmp_path / "a.spool")
    before = path.read_bytes()
    with pytest.raises(spool.SpoolError, match="a.spool: "):
        spool.append_meta(path, {"a": float("nan")})
    real = os.fsync
    monkeypatch.setattr(os, "fsync", lambda handle: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(spool.SpoolError, match="a.spool: No space left on device") as caught:
        spool.append_meta(path, {"a": 2})
    monkeypatch.setattr(os, "fsync", real)
    assert caught.value.kind == "io" and path.read_bytes() == before
    for _ in range(63):
        spool.append_meta(path, {"a": 2})
    with pytest.raises(spool.SpoolError, match="no more records fit"):
        spool.append_meta(path, {"a": 2})
    assert spool.check(path).ok

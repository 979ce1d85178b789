import pytest
import spool
from spool import meta


@pytest.mark.parametrize("text", [
    "{}", '{"a":1.5e300,"b":[true,false,null,"\u00e4\\n\\ud83d\\ude00"]}', '{"a":1}\n ', '{"a":' + "[" * 63 + "]" * 63 + "}"])
def test_json_objects_pass(text):
    assert isinstance(meta.decode(text.encode()), dict)


@pytest.mark.parametrize("payload", [
    b"", b"{", b"[]", b" {}", b"\xef\xbb\xbf{}", b"{}x", b"{'a':1}", b'{"a":NaN}', b'{"a":-Infinity}', b'{"a":1e999}',
    b'{"a":' + b"9" * 400 + b"}", b'{"a":"\xff"}', b'{"a":"\\ud800"}', b'{"\\udc00":1}', b'{"a":01}', b'{"a":1,}', b'{"a"}',
    b'{"a":"\n"}', b'{"a":' + b"[" * 64 + b"]" * 64 + b"}", b'{"a":' + b"[" * 100000 + b"]" * 100000 + b"}",
    b'{"a":"' + b"x" * (1 << 20) + b'"}'])
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


@pytest.mark.parametrize("value", [{"a": float("nan")}, {"a": object()}, "[]", {"a": "\ud800"}, {"a": 10**400}])
def test_writer_refuses_what_the_reader_would(tmp_path, value):
    with pytest.raises(spool.SpoolError) as caught:
        spool.Writer(tmp_path / "meta.spool", 1, 1, 1, {"radiance": ("f4", "RGB")}, meta=value)
    assert caught.value.kind == "usage"
    assert not list(tmp_path.iterdir())

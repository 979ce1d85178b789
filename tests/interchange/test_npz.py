import hashlib
import io
import json
import struct
import warnings
import zipfile

import numpy as np
import pytest
import spool

from conftest import run_jobs


def meta_array(**values):
    return np.frombuffer(json.dumps({"spool_npz": 1, "layout": "HWSC", **values}).encode(), np.uint8)


def radiance(rng, height=5, width=9, spp=4):
    return rng.random((height, width, spp, 3), np.float32)


def run(*job):
    return run_jobs(job)[0]


@pytest.mark.parametrize("seed", range(40))
def test_numpy_to_spool_to_numpy_is_bit_exact(tmp_path, seed):
    rng = np.random.default_rng(seed)
    height, width, spp = (int(value) for value in rng.integers(1, 30, 3))
    shw = bool(rng.integers(2))

    def layer(components, dtype):
        shape = (spp, height, width) if shw else (height, width, spp)
        bits = rng.integers(0, 256, int(np.prod(shape)) * max(components, 1) * np.dtype(dtype).itemsize, np.uint8)
        if dtype == "?":
            bits &= 1
        return bits.view(dtype).reshape(shape + ((components,) if components else ()))
    arrays = {"radiance": layer(3, "<f4"), "normal": layer(3, "<f2"), "depth": layer(0, "<f4"), "path": layer(1, "<u4"),
              "hit": layer(0, "?" if rng.integers(2) else "u1"), "half_vector": layer(2, "<f4"),
              "film": rng.random((spp, 2), np.float32), "reference": rng.random((height, width, 3), np.float32)}
    order = ["renderer", "exchangeable"][seed % 2]
    meta = meta_array(layout="SHWC" if shw else "HWSC", scope={"film": "pass"}, channels={"half_vector": ["U", "V"]},
                      sample_order=order, scene="random", renderer={"name": "none"})
    save = np.savez_compressed if rng.integers(2) else np.savez
    source, dump_path, target = tmp_path / "a.npz", tmp_path / "a.spool", tmp_path / "b.npz"
    save(source, meta=meta, **arrays)
    block = int(rng.integers(0, 9))
    jobs = run_jobs(("import npz", source, dump_path, "tile=8", f"block={block}", *(["compress"] if rng.integers(2) else [])),
                    ("export npz", dump_path, target))
    assert [code for code, _ in jobs] == [0, 0], jobs
    assert spool.check(dump_path).ok

    def hwsc(name):
        array = arrays[name]
        if shw and name not in ("film", "reference"):
            array = np.moveaxis(array, 0, 2)
        return array.astype("<u4") if array.dtype.itemsize == 1 else array
    with spool.open(dump_path) as dump:
        assert dump.sample_order == order and dump.block_spp == (block or 16)
        assert dump.meta["scene"] == "random" and dump.meta["renderer"] == {"name": "none"}
        record = dump.meta["import"]
        assert record["format"] == "npz" and record["files"] == [
            {"name": "a.npz", "bytes": source.stat().st_size, "sha256": hashlib.sha256(source.read_bytes()).hexdigest()}]
        assert record["converted"] == [f"hit: {arrays['hit'].dtype.str[1:]} to u4"] and record["precision"] == "half"
        assert dump.read("radiance").tobytes() == np.ascontiguousarray(hwsc("radiance")).tobytes()
        assert dump.read("half_vector").tobytes() == np.ascontiguousarray(hwsc("half_vector")).tobytes()
        assert dump.layers["half_vector"].components == ("U", "V") and dump.layers["path"].components == ("flags",)
        assert (dump.passes("film") == arrays["film"]).all() and (dump.pixel("reference") == arrays["reference"]).all()
    with np.load(target) as back:
        for name in arrays:
            expected = np.ascontiguousarray(hwsc(name))
            found = back[name]
            assert found.dtype == expected.dtype and found.tobytes() == expected.tobytes(), name
            assert found.shape == (expected.shape[:-1] if expected.shape[-1:] == (1,) and name == "path" else expected.shape), name
        meta = json.loads(back["meta"].tobytes())
        assert meta["layout"] == "HWSC" and meta["sample_order"] == order and meta["scope"]["film"] == "pass"
        assert meta["channels"]["half_vector"] == ["U", "V"]
    assert zipfile.ZipFile(target).testzip() is None
    # and once more through the exported file
    again = tmp_path / "c.spool"
    assert run("import npz", target, again, "tile=8")[0] == 0
    with spool.open(dump_path) as first, spool.open(again) as second:
        for name, entry in first.layers.items():
            read = {"sample": "read", "pixel": "pixel", "pass": "passes"}[entry.scope]
            assert getattr(first, read)(name).tobytes() == getattr(second, read)(name).tobytes()
            assert entry.components == second.layers[name].components


def test_remarks_about_layers_survive(tmp_path):
    samples = radiance(np.random.default_rng(1))
    source, dump_path, target = tmp_path / "a.npz", tmp_path / "a.spool", tmp_path / "b.npz"
    np.savez(source, radiance=samples, normal=samples, meta=meta_array(channels={"normal": {"space": "camera"}}))
    assert [code for code, _ in run_jobs(("import npz", source, dump_path), ("export npz", dump_path, target))] == [0, 0]
    assert spool.open(dump_path).meta["channels"] == {"normal": {"space": "camera"}}
    channels = json.loads(np.load(target)["meta"].tobytes())["channels"]
    assert channels["normal"] == {"space": "camera", "components": ["X", "Y", "Z"]}


def test_meta_may_be_a_string_array(tmp_path):
    samples = radiance(np.random.default_rng(1))
    for number, meta in enumerate((json.dumps({"scene": "\u00e4\u20ac\U0001F600"}, ensure_ascii=False), b'{"scene":"x"}')):
        source, out = tmp_path / f"{number}.npz", tmp_path / f"{number}.spool"
        np.savez(source, radiance=samples, meta=np.array(meta))
        assert run("import npz", source, out, "layout=HWSC") == (0, "")
        assert spool.open(out).meta["scene"] == json.loads(meta)["scene"]


def test_more_layers_than_groups_share_groups(tmp_path):
    samples = radiance(np.random.default_rng(2))
    arrays = {f"l{number}": samples[..., 0] * number for number in range(20)}
    arrays.update({f"r{number}": (samples[..., 0] * number).astype("f2") for number in range(5)})
    source, out = tmp_path / "a.npz", tmp_path / "a.spool"
    np.savez(source, radiance=samples, **arrays, meta=meta_array(channels={name: ["V"] for name in arrays}))
    assert run("import npz", source, out, "tile=8", "block=3") == (0, "")
    with spool.open(out) as dump:
        assert dump.geometry.group_count == 3
        for name, array in arrays.items():
            assert (dump.read(name)[..., 0] == array).all()


def test_f8_needs_narrow(tmp_path):
    samples = np.random.default_rng(3).random((4, 4, 2, 3))
    source, out = tmp_path / "a.npz", tmp_path / "a.spool"
    np.savez(source, radiance=samples)
    code, message = run("import npz", source, out, "layout=HWSC")
    assert code == 1 and "import.narrow" in message
    assert run("import npz", source, out, "layout=HWSC", "narrow")[0] == 0
    with spool.open(out) as dump:
        assert (dump.read("radiance") == samples.astype("f4")).all()
        assert dump.meta["import"]["converted"] == ["radiance: f8 to f4"]
    np.savez(source, radiance=samples * 1e39)
    code, message = run("import npz", source, out, "layout=HWSC", "narrow", "force")
    assert code == 1 and "beyond float32" in message


def test_unusual_values_are_stored_counted_and_told(tmp_path):
    samples = radiance(np.random.default_rng(4))
    samples[0, 0, 0] = np.nan, np.inf, -0.0
    half = samples.astype("f2")
    half[1, 1, 1, 0] = 65504
    source, out = tmp_path / "a.npz", tmp_path / "a.spool"
    np.savez(source, radiance=samples, albedo=half, meta=meta_array())
    code, notes = run("import npz", source, out)
    assert code == 0 and "not finite, stored as they are: 4" in notes and "half-float limit, clamped by the renderer: 1" in notes
    assert spool.open(out).read("radiance").tobytes() == samples.tobytes()


@pytest.mark.parametrize("dtype", ["f2", "f4"])
def test_a_variance_below_zero_is_named_with_its_pixel(tmp_path, dtype):
    variance = np.zeros((20, 70, 3), dtype)
    variance[11, 66, 1] = -0.5
    np.savez(tmp_path / "a.npz", radiance=np.ones((20, 70, 2, 3), "f4"), reference=np.ones((20, 70, 3), "f4"), reference_variance=variance, meta=meta_array())
    code, message = run("import npz", tmp_path / "a.npz", tmp_path / "a.spool")
    assert code == 1 and "a.npz: reference_variance of pixel 66,11 is -0.5" in message, message
    assert [path.name for path in tmp_path.iterdir()] == ["a.npz"]


def test_a_meaning_that_is_none_is_named(tmp_path):
    for semantic in (7, [7], [7, 10, 1], ["x"] * 3, [-1] * 3):
        np.savez(tmp_path / "a.npz", radiance=np.ones((2, 3, 2, 3), "f4"), meta=meta_array(semantic={"radiance": semantic}))
        code, message = run("import npz", tmp_path / "a.npz", tmp_path / "a.spool")
        assert code == 1 and "meta.semantic.radiance is" in message, message


def test_existing_files_are_kept(tmp_path):
    source, out = tmp_path / "a.npz", tmp_path / "a.spool"
    np.savez(source, radiance=radiance(np.random.default_rng(1)), meta=meta_array())
    out.write_bytes(b"precious")
    assert run("import npz", source, out)[0] == 2 and out.read_bytes() == b"precious"
    assert run("import npz", source, out, "force")[0] == 0
    back = tmp_path / "b.npz"
    back.write_bytes(b"precious")
    assert run("export npz", out, back)[0] == 2 and back.read_bytes() == b"precious"
    assert run("export npz", out, back, "force")[0] == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.npz", "a.spool", "b.npz"]


def test_dump_with_holes_is_not_exported(tmp_path):
    with spool.Writer(tmp_path / "a.spool", 8, 8, 2, {"radiance": ("f4", "RGB")}, tile_size=8):
        pass
    code, message = run("export npz", tmp_path / "a.spool", tmp_path / "a.npz")
    assert code == 1 and "blocks are missing" in message and not (tmp_path / "a.npz").exists()


def refused(tmp_path, data, *options):
    """Code and message; nothing but the input may remain."""
    source, out = tmp_path / "bad.npz", tmp_path / "bad.spool"
    source.write_bytes(data)
    code, message = run("import npz", source, out, *options)
    assert message.startswith(str(source)) and "\n" not in message
    assert [path.name for path in tmp_path.iterdir() if path.name != "bad.spool.partial"] == ["bad.npz"]
    return code, message


def savez(**arrays):
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


SAMPLES = radiance(np.random.default_rng(6), 3, 2, 2)


@pytest.mark.parametrize("code, words, arrays", [
    (1, "no array radiance, the first is color", {"color": SAMPLES}),
    (1, "no real numbers", {"radiance": SAMPLES.astype("c8")}),
    (1, "big-endian array: save with astype('<f4')", {"radiance": SAMPLES.astype(">f4")}),
    (1, "use np.ascontiguousarray", {"radiance": np.asfortranarray(SAMPLES)}),
    (1, "pickles", {"radiance": SAMPLES, "depth": np.array([{}], object)}),
    (1, "structured array", {"radiance": SAMPLES, "depth": np.zeros((3, 2, 2), [("a", "f4")])}),
    (1, "dtype <i8", {"radiance": SAMPLES, "depth": np.zeros((3, 2, 2), "i8")}),
    (1, "dtype <c8", {"radiance": SAMPLES.astype("c8")}),
    (1, "radiance: dtype <u4", {"radiance": SAMPLES.astype("u4")}),
    (1, 'meta.layout is "\\u001b[2J\\n"', {"radiance": SAMPLES, "meta": meta_array(layout="\x1b[2J\n")}),
    (1, "normal: shape (3,2,2,4), expected 3 components", {"radiance": SAMPLES, "normal": np.zeros((3, 2, 2, 4), "f4")}),
    (1, "expected 4 axes", {"radiance": SAMPLES[0]}),
    (1, "depth is 2x2 with 2 samples but radiance is 2x3 with 2", {"radiance": SAMPLES, "depth": np.zeros((2, 2, 2), "f4")}),
    (1, "reference is", {"radiance": SAMPLES, "reference": np.zeros((3, 3, 3), "f4")}),
    (1, "name its components", {"radiance": SAMPLES, "half_vector": SAMPLES}),
    (1, "not a layer name", {"radiance": SAMPLES, "Normal": SAMPLES}),
    (1, "not a layer name", {"radiance": SAMPLES, "n" * 30: SAMPLES}),
    (1, "nothing can be stored", {"radiance": SAMPLES[:0]}),
    (1, "save one JSON object", {"radiance": SAMPLES, "meta": np.frombuffer(b"[1]", "u1")}),
    (1, 'meta.layout is "HWC"', {"radiance": SAMPLES, "meta": meta_array(layout="HWC")}),
    (1, 'meta.sample_order is "sorted"', {"radiance": SAMPLES, "meta": meta_array(sample_order="sorted")}),
    (1, 'meta.pixel_filter is "gaussian"', {"radiance": SAMPLES, "meta": meta_array(pixel_filter="gaussian")}),
    (1, 'meta.colour_space is "acescg"', {"radiance": SAMPLES, "meta": meta_array(colour_space="acescg")}),
    (1, 'meta.film is "lens"', {"radiance": SAMPLES, "film": SAMPLES[..., :2], "meta": meta_array(scope={"film": "lens"})}),
    (1, "not an object", {"radiance": SAMPLES, "meta": meta_array(scope=[])}),
    (1, "not a list of names", {"radiance": SAMPLES, "depth": SAMPLES[..., 0], "meta": meta_array(channels={"depth": [1]})}),
    (1, "meta: <f4", {"radiance": SAMPLES, "meta": SAMPLES})])
def test_unusable_arrays_are_named(tmp_path, code, words, arrays):
    found, message = refused(tmp_path, savez(**arrays), *([] if "meta" in arrays else ["layout=HWSC"]))
    assert words in message and found == code, message


def test_layout_is_never_guessed(tmp_path):
    for arrays in ({}, {"meta": np.frombuffer(b'{"spool_npz": 1}', "u1")}):
        code, message = refused(tmp_path, savez(radiance=SAMPLES, **arrays))
        assert code == 2 and "order of axes is unknown: give --set import.layout" in message
    code, message = refused(tmp_path, savez(radiance=SAMPLES, meta=meta_array(layout="HWSC")), "layout=SHWC")
    assert code == 2 and "leave import.layout out" in message


def zipped(header, payload=SAMPLES.tobytes(), length="<H"):
    """One member with a header of one's own: the text, or (magic and version, text)."""
    start, text = header if isinstance(header, tuple) else (b"\x93NUMPY\1\0", header)
    text = text.encode()
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("radiance.npy", start + struct.pack(length, len(text)) + text + payload)
    return file.getvalue()


GOOD = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2, 2, 3), }"


def test_header_variants_numpy_may_write(tmp_path):
    version2 = (b"\x93NUMPY\2\0", GOOD + "\n")
    for number, data in enumerate((
            zipped(GOOD), zipped(GOOD + "\n"), zipped('{"shape":(3,2,2,3),"descr":"<f4","fortran_order":False}'),
            zipped("{'descr': '<f4', 'fortran_order': False, 'shape': (3L, 2L, 2L, 3L)}"), zipped(version2, length="<I"))):
        (tmp_path / f"{number}.npz").write_bytes(data)
        assert run("import npz", tmp_path / f"{number}.npz", tmp_path / f"{number}.spool", "layout=HWSC") == (0, "")
        assert spool.open(tmp_path / f"{number}.spool").read("radiance").tobytes() == SAMPLES.tobytes()


@pytest.mark.parametrize("header", [
    "", "{", "{}", "[]", GOOD[:-1], GOOD + "x", GOOD.replace("False", "0"), GOOD.replace("False", "false"), GOOD.replace("'<f4'", "<f4"),
    GOOD.replace("(3, 2, 2, 3)", "[3, 2, 2, 3]"), GOOD.replace("(3, 2, 2, 3)", "(3, 2, 2, -3)"), GOOD.replace("(3, 2, 2, 3)", "(36)"),
    GOOD.replace("(3, 2, 2, 3)", "(3, 2, 2, 3.0)"), GOOD.replace("(3, 2, 2, 3)", "(3, 2, 2, 3"), GOOD.replace("(3, 2, 2, 3)", "(,)"),
    GOOD.replace("(3, 2, 2, 3)", "(" + "1," * 33 + ")"), GOOD.replace("(3, 2, 2, 3)", "(99999999999999999999999, 1, 1, 3)"),
    GOOD.replace(", }", ", 'extra': 1}"), GOOD.replace(", }", ", 'descr': '<f4'}"), GOOD.replace("'shape'", "'shap'"),
    GOOD.replace("'<f4'", "__import__('os')"), GOOD.replace("'<f4'", "'<f4\\n'"), (b"\x93NUMPX\1\0", GOOD),
    (b"\x93NUMPY\2\0", GOOD)])
def test_header_that_numpy_cannot_have_written_is_damage(tmp_path, header):
    code, message = refused(tmp_path, zipped(header), "layout=HWSC")
    assert code == 4 and "radiance" in message, message


def test_a_version_of_npy_that_is_newer_is_no_damage(tmp_path):
    code, message = refused(tmp_path, zipped((b"\x93NUMPY\4\0", GOOD)), "layout=HWSC")
    assert code == 1 and "version 4 of .npy is unknown here" in message, message


def test_whole_numbers_are_no_measure_of_any_layer(tmp_path):
    for layer, array, word in (("reference", SAMPLES[:, :, 0], "no light"), ("albedo", SAMPLES, "encoded"), ("normal", SAMPLES, "encoded")):
        np.savez(tmp_path / "a.npz", radiance=SAMPLES, **{layer: (array * 0).astype("u1")})
        code, message = run_jobs(("import npz", tmp_path / "a.npz", tmp_path / "a.spool", "layout=HWSC"))[0]
        assert code == 1 and word in message and layer in message, message


def test_bytes_of_a_display_are_no_light(tmp_path):
    for dtype in ("u1", "i2", "u4", "?"):
        code, message = refused(tmp_path, savez(radiance=(255 * SAMPLES).astype(dtype)), "layout=HWSC")
        assert code == 1 and "divide by the largest value, linearise where it is sRGB" in message, message


@pytest.mark.parametrize("shape", ["(3, 2, 2, 4)", "(3, 2, 1, 3)", "(4294967296, 4294967296, 1, 3)", "(9223372036854775808, 2, 1, 3)",
                                   "(65536, 65536, 65536, 3)", "()"])
def test_shape_lies_are_damage(tmp_path, shape):
    code, message = refused(tmp_path, zipped(GOOD.replace("(3, 2, 2, 3)", shape)), "layout=HWSC")
    assert code == 4 and "is not" in message


def test_no_truncation_is_taken(tmp_path):
    for save in (np.savez, np.savez_compressed):
        file = io.BytesIO()
        save(file, radiance=SAMPLES, meta=meta_array())
        good = file.getvalue()
        jobs = []
        for size in range(len(good)):
            path = tmp_path / f"{size}.npz"
            path.write_bytes(good[:size])
            jobs.append(("import npz", path, tmp_path / f"{size}.spool"))
        assert {code for code, _ in run_jobs(*jobs)} == {4}
        assert not list(tmp_path.glob("*.spool*"))


def test_flipped_bits_never_change_a_sample(tmp_path):
    """Refused, or (in a date, say) the samples are the same."""
    for number, save in enumerate((np.savez, np.savez_compressed)):
        file = io.BytesIO()
        save(file, radiance=SAMPLES, meta=meta_array())
        good = file.getvalue()
        rng = np.random.default_rng(5)
        jobs = []
        for at in range(len(good)):
            bad = bytearray(good)
            bad[at] ^= 1 << int(rng.integers(8))
            path = tmp_path / f"{number}_{at}.npz"
            path.write_bytes(bad)
            jobs.append(("import npz", path, path.with_suffix(".spool"), "tile=8"))
        taken = 0
        for (_, _, out, _), (code, message) in zip(jobs, run_jobs(*jobs)):
            assert code in (0, 1, 4), message
            if code == 0:
                taken += 1
                assert spool.open(out).read("radiance").tobytes() == SAMPLES.tobytes()
        assert taken < len(good) // 4


def patched(data, signature, offset, value, which=0):
    at = -1
    for _ in range(which + 1):
        at = data.index(signature, at + 1)
    return data[:at + offset] + value + data[at + offset + len(value):]


LOCAL, CENTRAL, END = b"PK\3\4", b"PK\1\2", b"PK\5\6"


def test_zip_lies(tmp_path):
    good = savez(radiance=SAMPLES, depth=SAMPLES[..., 0])
    for words, code, data in (
            ("encrypted", 1, patched(good, CENTRAL, 8, b"\1\0")),
            ("method 12", 1, patched(good, CENTRAL, 10, b"\x0c\0")),
            ("several disks", 1, patched(good, END, 4, b"\1\0")),
            ("is damaged", 4, patched(good, LOCAL, 8, b"\x08\0")),
            ("checksum", 4, patched(good, CENTRAL, 16, b"\0\0\0\0")),
            ("cannot hold", 4, patched(good, CENTRAL, 24, b"\0\0\0\x7f")),
            ("cut", 4, patched(patched(good, CENTRAL, 24, b"\0\0\0\x7f"), CENTRAL, 20, b"\0\0\0\x7f")),
            ("lies outside", 4, patched(good, CENTRAL, 42, b"\0\0\0\x7f")),
            ("zip64", 4, patched(good, CENTRAL, 24, b"\xff\xff\xff\xff")),
            ("zip64", 4, patched(good, END, 16, b"\xff\xff\xff\xff")),
            ("does not end", 4, patched(good, END, 16, b"\0\0\0\0")),
            ("does not end", 4, patched(good, END, 12, b"\xff\xff\0\0")),
            ("another name", 4, patched(good, LOCAL, 30, b"x")),
            ("occurs twice", 1, duplicate_names()),
            ("overlap", 4, overlapping())):
        found, message = refused(tmp_path, data, "layout=HWSC")
        assert found == code and words in message, (words, message)


def duplicate_names():
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(2):
            archive.writestr("radiance.npy", b"x")
    return file.getvalue()


def overlapping():
    """Two directory entries whose data are the same bytes, as in overlap bombs."""
    inner = savez(radiance=SAMPLES)
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("outer.npy", inner[:inner.index(CENTRAL)])
    data = bytearray(file.getvalue())
    at = data.index(CENTRAL)
    entry = bytearray(inner[inner.index(CENTRAL):inner.index(END)])
    entry[42:46] = (data.index(LOCAL, 1)).to_bytes(4, "little")
    end = data.index(END)
    directory = bytes(data[at:end]) + bytes(entry)
    tail = bytearray(data[end:])
    tail[8:12] = b"\2\0\2\0"
    tail[12:16] = len(directory).to_bytes(4, "little")
    return bytes(data[:at]) + directory + bytes(tail)


def test_bombs_are_refused_before_they_are_inflated(tmp_path):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("radiance.npy", b"\x93NUMPY\1\0" + struct.pack("<H", len(GOOD)) + GOOD.encode() + bytes(64 << 20))
    code, message = refused(tmp_path, file.getvalue(), "layout=HWSC")
    assert code == 4 and "is not" in message
    code, message = refused(tmp_path, patched(file.getvalue(), CENTRAL, 24, struct.pack("<I", 144 + 10 + len(GOOD))), "layout=HWSC")
    assert code == 4 and "more than its size" in message, message


def test_archives_of_more_than_numpy_writes(tmp_path):
    """zip64 in the directory, comments and data before the first member."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.comment = b"a comment PK\5\6 with a signature in it"
        info = zipfile.ZipInfo("radiance.npy")
        array = io.BytesIO()
        np.save(array, SAMPLES)
        with archive.open(info, "w", force_zip64=True) as member:
            member.write(array.getvalue())
    path = tmp_path / "a.npz"
    path.write_bytes(file.getvalue())
    assert run("import npz", path, tmp_path / "a.spool", "layout=HWSC") == (0, "")
    assert spool.open(tmp_path / "a.spool").read("radiance").tobytes() == SAMPLES.tobytes()


def test_sizes_and_offsets_past_4_gib(tmp_path):
    path = tmp_path / "big.zip"
    code, members = run("sparse_zip", "-", path)
    assert code == 0 and path.stat().st_blocks * 512 < 1 << 20
    big, small = zipfile.ZipFile(path).infolist()
    assert (big.file_size, small.file_size, big.header_offset) == (5 << 30, 3, 0)
    assert zipfile.ZipFile(path).read("small") == b"abc"
    assert members == f"big {5 << 30} 53; small 3 {small.header_offset + 35}; "

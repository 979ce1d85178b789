"""Folders of one-sample EXR images: our own, and what OpenImageIO writes under others' names."""
import json

import numpy as np
import OpenImageIO as oiio
import pytest
import spool
import spool.exr

import exr_files
import sample_dumps
from conftest import run_jobs

RNG = np.random.default_rng(8)
SAMPLES = RNG.random((4, 6, 5, 3), np.float32)  # [s][y][x][c]


def write_image(path, channels, pixels, attributes=(), dtype=oiio.FLOAT, origin=(0, 0)):
    """pixels [y][x][channel]."""
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, dtype)
    spec.channelnames = tuple(channels)
    spec.x, spec.y = origin
    for name, value in attributes:
        spec.attribute(name, value)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec) and out.write_image(pixels) and out.close()


def folder(tmp_path, channels, arrays, **options):
    target = tmp_path / "renders"
    target.mkdir()
    for s, pixels in enumerate(arrays):
        write_image(target / f"frame_{s + 3:03}.exr", channels, pixels, **options)
    return target


def imported(tmp_path, source, *options):
    code, message = run_jobs(("import exr-folder", source, tmp_path / "a.spool", *options))[0]
    return code, message, tmp_path / "a.spool"


@pytest.mark.parametrize("seed", range(5))
def test_our_own_folder_comes_back_bit_for_bit(tmp_path, seed):
    arrays = sample_dumps.rich(tmp_path / "a.spool", seed, size=(3 + seed, 10), spp=2 + 3 * seed)
    results = run_jobs(("export exr-folder", tmp_path / "a.spool", tmp_path / "out"),
                       ("import exr-folder", tmp_path / "out", tmp_path / "b.spool", "tile=8", "block=5"))
    assert [code for code, _ in results] == [0, 0], results
    assert sample_dumps.assert_same(tmp_path / "b.spool", arrays) == set(arrays)
    with spool.open(tmp_path / "b.spool") as dump:
        assert dump.sample_order == "exchangeable" and dump.meta["renderer"] == {"name": "test"}


def test_plain_images(tmp_path):
    code, message, path = imported(tmp_path, folder(tmp_path, "RGB", list(SAMPLES)))
    assert code == 0, message
    sample_dumps.assert_same(path, {"radiance": np.ascontiguousarray(SAMPLES.transpose(1, 2, 0, 3))})


def test_names_of_blender(tmp_path):
    names = [f"View.Layer.{name}" for name in
             ("Combined.R", "Combined.G", "Combined.B", "Combined.A", "Depth.Z", "Normal.X", "Normal.Y", "Normal.Z",
              "DiffCol.R", "DiffCol.G", "DiffCol.B", "Mist.Z")]
    pixels = RNG.random((3, 4, 5, len(names)), np.float32)
    source = folder(tmp_path, names, list(pixels), attributes=[("BlenderMultiChannel", "Blender V2.55.1"), ("cycles.View.Layer.samples", "1")])
    code, message, path = imported(tmp_path, source)
    assert code == 0 and "Mist" in message and "Combined.A" in message
    at = pixels.transpose(1, 2, 0, 3)
    names = sample_dumps.assert_same(path, {"radiance": at[..., :3].copy(), "depth": at[..., 4].copy(),
                                            "normal": at[..., 5:8].copy(), "albedo": at[..., 8:11].copy()})
    assert names == {"radiance", "depth", "normal", "albedo"}


def test_names_with_layers_half_floats_and_a_moved_window(tmp_path):
    channels = ["R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z", "Ns.X", "Ns.Y", "Ns.Z", "Z", "odd.R"]
    pixels = RNG.random((2, 3, 4, len(channels)), np.float32).astype(np.float16)
    code, message, path = imported(tmp_path, folder(tmp_path, channels, list(pixels), dtype=oiio.HALF, origin=(7, -2)))
    assert code == 0 and "odd.R" in message and "7,-2" in message
    at = pixels.transpose(1, 2, 0, 3)
    sample_dumps.assert_same(path, {"radiance": at[..., :3].copy(), "albedo": at[..., 3:6].copy(), "normal_geo": at[..., 6:9].copy(),
                                    "normal": at[..., 9:12].copy(), "depth": at[..., 12].copy()})


@pytest.mark.parametrize("display, told", [((0, 0, 4, 3), False), ((1, 0, 3, 3), True), ((0, 0, 40, 30), True)])
def test_a_display_window_that_differs_is_told(tmp_path, display, told):
    (tmp_path / "renders").mkdir()
    for s in range(2):
        picture = exr_files.rgb(RNG.random((3, 4, 3), np.float32))
        exr_files.write(tmp_path / "renders" / ("a%d.exr" % s), exr_files.Part(picture, display=display))
    code, message, path = imported(tmp_path, tmp_path / "renders")
    assert code == 0 and ("all of the data window (x 0 to 3, y 0 to 2) was taken, the display window is another" in message) == told, message


def test_a_layer_can_be_named(tmp_path):
    channels = ["beauty.red", "beauty.green", "beauty.blue", "my stuff.R", "my stuff.G", "my stuff.B"]
    pixels = RNG.random((2, 3, 4, 6), np.float32)
    code, message, path = imported(tmp_path, folder(tmp_path, channels, list(pixels)), "map=albedo=my stuff")
    assert code == 0, message
    at = pixels.transpose(1, 2, 0, 3)
    sample_dumps.assert_same(path, {"radiance": at[..., :3].copy(), "albedo": at[..., 3:].copy()})


@pytest.mark.parametrize("options, words", [
    (["map=radiance=a", "layer=b"], "both choose radiance: give one"), (["map=albdeo=b", "layer=a"], "did you mean 'albedo'")])
def test_choices_that_contradict_each_other_or_are_misspelt(tmp_path, options, words):
    source = folder(tmp_path, [f"{layer}.{c}" for layer in "ab" for c in "RGB"], list(RNG.random((2, 3, 4, 6), np.float32)))
    code, message, path = imported(tmp_path, source, *options)
    assert code == 2 and words in message and not path.exists(), message
    for own in ("emit", "indirect", "albedo_2"):
        assert imported(tmp_path, source, f"map={own}=b", "layer=a", "force")[0] == 0


@pytest.mark.parametrize("names, layers", [("blender", ["radiance", "albedo", "depth"]), ("rgb", ["radiance"])])
def test_export_under_other_names(tmp_path, names, layers):
    arrays = sample_dumps.rich(tmp_path / "a.spool", 2)
    results = run_jobs(("export exr-folder", tmp_path / "a.spool", tmp_path / "out", f"names={names}"),
                       ("import exr-folder", tmp_path / "out", tmp_path / "b.spool"))
    assert [code for code, _ in results] == [0, 0], results
    assert "path is not written" in results[0][1] and "film is not written" in results[0][1]
    assert sample_dumps.assert_same(tmp_path / "b.spool", arrays, layers) >= set(layers)
    first = oiio.ImageInput.open(str(tmp_path / "out" / "sample_0000.exr")).spec().channelnames
    assert ("ViewLayer.Combined.R" if names == "blender" else "R") in first


def test_an_export_leaves_no_images_of_a_longer_one(tmp_path):
    for name, spp in (("long", 4), ("short", 2)):
        spool.write(tmp_path / f"{name}.spool", np.ones((6, 5, spp, 3), "f4"))
    results = run_jobs(("export exr-folder", tmp_path / "long.spool", tmp_path / "out"),
                       ("export exr-folder", tmp_path / "short.spool", tmp_path / "out", "force=1"))
    assert [code for code, _ in results] == [0, 0], results
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["sample_0000.exr", "sample_0001.exr"]


def test_an_export_leaves_images_of_others_alone(tmp_path):
    for name, spp in (("long", 4), ("short", 2)):
        spool.write(tmp_path / f"{name}.spool", np.ones((6, 5, spp, 3), "f4"))
    assert run_jobs(("export exr-folder", tmp_path / "long.spool", tmp_path / "out"))[0][0] == 0
    write_image(tmp_path / "out" / "sample_of_hers.exr", "RGB", SAMPLES[0])
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    code, message = run_jobs(("export exr-folder", tmp_path / "short.spool", tmp_path / "out", "force=1"))[0]
    assert code == 2 and message.startswith(f"{tmp_path / 'out' / 'sample_of_hers.exr'}: is of no export by spool"), message
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


def taken_away(folder, name):
    (folder / name).unlink()


def without_layer(folder, name):
    pixels = spool.exr.read(folder / name)
    kept = [key for key in pixels if not key.startswith("reference")]
    write_image(folder / name, kept, np.dstack([pixels[key] for key in kept]).astype("f4"))


def from_another_recording(folder, name):
    spool.write(folder.parent / "other.spool", np.ones((6, 5, 4, 3), "f4"), reference=np.ones((6, 5, 3), "f4"), albedo=np.ones((6, 5, 3), "f4"),
                scope={"albedo": "pixel"})
    code, message = run_jobs(("export exr-folder", folder.parent / "other.spool", folder.parent / "other"))[0]
    assert code == 0, message
    (folder.parent / "other" / name).replace(folder / name)


@pytest.mark.parametrize("change, name, words", [
    (taken_away, "sample_0003.exr", "out: 3 images, sample_0000.exr says that the recording had 4 samples"),
    (taken_away, "sample_0000.exr", "out: 3 images, sample_0001.exr says that the recording had 4 samples"),
    (taken_away, "pixel_layers.exr", "pixel_layers.exr: is missing"),
    (without_layer, "pixel_layers.exr", "pixel_layers.exr: no channel reference.R"),
    (from_another_recording, "sample_0002.exr", "sample_0002.exr: of another recording"),
    (from_another_recording, "pixel_layers.exr", "pixel_layers.exr: of another recording")])
def test_an_export_of_ours_that_is_not_whole_is_refused(tmp_path, change, name, words):
    spool.write(tmp_path / "whole.spool", np.ascontiguousarray(SAMPLES.transpose(1, 2, 0, 3)), reference=SAMPLES[0], albedo=SAMPLES[1],
                scope={"albedo": "pixel"})
    code, message = run_jobs(("export exr-folder", tmp_path / "whole.spool", tmp_path / "out"))[0]
    assert code == 0, message
    change(tmp_path / "out", name)
    code, message, path = imported(tmp_path, tmp_path / "out")
    assert code == 1 and words in message and "\n" not in message.strip(), message
    assert not path.exists()


CHANNELS = [  # of scope, name; what an edited attribute lets the channels be
    (["pass radiance.R", "pass radiance.G", "pass radiance.B"], "radiance is not f16 or f32 of scope sample"),
    (["sample radiance.R", "sample radiance.G"], "channel_count is 2"),
    (["sample radiance.B", "sample radiance.G", "sample radiance.R"], "group 0 is not radiance.R, radiance.G, radiance.B"),
    (["sample radiance.R", "sample radiance.G", "sample radiance.B", "sample radiance.R"], "channel radiance.R occurs twice"),
    (["sample radiance.R", "sample radiance.G", "sample radiance.B", "sample a.X", "pass a.Y"], "channel a.Y differs in dtype or scope"),
    (["sample radiance.R", "sample radiance.G", "sample radiance.B", "sample a.X", "sample b.X", "sample a.Y"], "layer of channel a.Y is not one run"),
    (["sample radiance.R", "sample radiance.G", "sample radiance.B", "sample a b.X"], "name of channel 3 is not")]


@pytest.mark.parametrize("kind", ["exr-folder", "deep-exr"])
@pytest.mark.parametrize("channels, words", CHANNELS)
def test_an_edited_list_of_channels_is_named_in_its_file(tmp_path, kind, channels, words):
    spool.write(tmp_path / "a.spool", np.ascontiguousarray(SAMPLES.transpose(1, 2, 0, 3)))
    told = json.dumps([dict(zip(("scope", "name"), channel.split(" ", 1))) for channel in channels])
    out = tmp_path / ("out" if kind == "exr-folder" else "out.exr")
    assert run_jobs((f"export {kind}", tmp_path / "a.spool", out))[0][0] == 0
    for image in sorted(out.iterdir()) if out.is_dir() else [out]:
        exr_files.edited(image, lambda name, value: told if name == "spoolChannels" else value)
    code, message = run_jobs((f"import {kind}", out, tmp_path / "b.spool"))[0]
    first = out / "sample_0000.exr" if out.is_dir() else out
    assert code == 1 and message.startswith(f"{first}: attribute spoolChannels ({words}"), message
    assert not (tmp_path / "b.spool").exists()


def test_channels_that_are_no_recording_are_named_in_their_source(tmp_path):
    source = folder(tmp_path, "RGB", list(SAMPLES))
    write_image(source / "pixel_layers.exr", ["radiance.R"], SAMPLES[0][..., :1])
    code, message, path = imported(tmp_path, source)
    assert code == 1 and message.startswith("frame_003.exr: ") and "radiance" in message and not path.exists(), message


def test_order_and_semantics_of_channels_come_back(tmp_path):
    channels = [spool.Channel(name, group, dtype, semantic, scope) for name, group, dtype, semantic, scope in (
        ("radiance.R", 0, "f4", 1, "sample"), ("radiance.G", 0, "f4", 1, "sample"), ("radiance.B", 0, "f4", 1, "sample"),
        ("vu.V", 1, "f4", 7, "pixel"), ("vu.U", 1, "f4", 9, "pixel"), ("ba.B", 2, "f4", 7, "sample"), ("ba.A", 2, "f4", 3, "sample"),
        ("zy.Z", 3, "u4", 9, "pass"), ("zy.Y", 3, "u4", 2, "pass"))]
    with spool.Writer(tmp_path / "a.spool", 5, 6, 4, channels=channels) as writer:
        writer.write_passes(0, {"radiance": SAMPLES.transpose(1, 2, 0, 3), "ba": SAMPLES.transpose(1, 2, 0, 3)[..., 1:]})
        writer.write_pixel("vu", SAMPLES[0][..., :2])
        writer.write_pass("zy", np.arange(8, dtype="u4").reshape(4, 2))
    for kind, name in (("exr-folder", "out"), ("deep-exr", "out.exr"), ("npz", "out.npz")):
        results = run_jobs((f"export {kind}", tmp_path / "a.spool", tmp_path / name), (f"import {kind}", tmp_path / name, tmp_path / f"{kind}.spool"))
        assert [code for code, _ in results] == [0, 0], results
        with spool.open(tmp_path / f"{kind}.spool") as dump:
            assert np.array_equal(dump.pixel("vu"), SAMPLES[0][..., :2]), kind
            assert {c.name: (c.semantic, c.scope) for c in dump.channels} == {c.name: (c.semantic, c.scope) for c in channels}, kind
            assert [c.name for c in dump.channels if c.name[:2] == "vu"] == ["vu.V", "vu.U"]


@pytest.mark.parametrize("value, words", [
    ("f32:00000001", "seed changes its type (image 1)"), ("zzz:00000001", "image 1 has no attribute spoolPass.seed.S"),
    ("f16:12345678", "image 1 has no attribute spoolPass.seed.S"), ("u32:0000000g", "image 1 has no attribute spoolPass.seed.S")])
def test_an_edited_value_of_a_pass_is_no_other_number(tmp_path, value, words):
    spool.write(tmp_path / "whole.spool", np.ascontiguousarray(SAMPLES.transpose(1, 2, 0, 3)), seed=np.array([7, 6, 6, 5], "u4"), scope={"seed": "pass"})
    assert run_jobs(("export exr-folder", tmp_path / "whole.spool", tmp_path / "out"))[0][0] == 0
    exr_files.edited(tmp_path / "out" / "sample_0001.exr", lambda name, old: value if name == "spoolPass.seed.S" else old)
    code, message, path = imported(tmp_path, tmp_path / "out")
    assert code == 1 and words in message and not path.exists(), message


def test_a_compression_with_loss_is_remarked_in_every_image_and_layer(tmp_path):
    source = folder(tmp_path, "RGB", list(SAMPLES))
    write_image(source / "frame_005.exr", "RGB", SAMPLES[2], attributes=[("compression", "dwaa")])
    write_image(source / "pixel_layers.exr", ["reference.R", "reference.G", "reference.B"], SAMPLES[0], attributes=[("compression", "dwaa")])
    code, message, _ = imported(tmp_path, source)
    assert code == 0 and "DWA is a compression with loss: the values of 1 of 4 images" in message and "of 1 of 1 images" in message, message


NAMES = [  # in the order of their numbers, and what is said of them
    (["a_-0002.exr", "a_-0001.exr", "a_0000.exr", "a_0001.exr"], "numbered -2 to 1"),
    (["a-2.exr", "a-1.exr", "a0.exr", "a1.exr"], "numbered -2 to 1"),
    (["-4.exr", "-3.exr", "-2.exr", "-1.exr"], "numbered -4 to -1"),
    (["a-1.exr", "a-2.exr", "a-3.exr", "a-4.exr"], ""),
    (["a8.exr", "a9.exr", "a10.exr", "a011.exr"], ""),
    (["a_1.exr", "a_2.EXR", "A_3.Exr", "a_4.eXr"], ""),
    (["a2024112512%010d.exr" % i for i in range(4)], ""),
    (["a1_x.exr", "b2_x.exr", "a3_x.exr", "a4_x.exr"], "names differ beside their numbers: a1_x.exr and b2_x.exr"),
]


@pytest.mark.parametrize("names, words", NAMES)
def test_images_are_taken_in_the_order_of_their_numbers(tmp_path, names, words):
    (tmp_path / "f").mkdir()
    for name, pixels in zip(names, SAMPLES):
        write_image(tmp_path / "a.exr", "RGB", pixels)
        (tmp_path / "a.exr").rename(tmp_path / "f" / name)
    code, message, path = imported(tmp_path, tmp_path / "f")
    assert code == 0 and words in message and ("a1_x" in message or "differ" not in message), message
    assert ("is a sign" in message) == ("numbered" in words), message
    sample_dumps.assert_same(path, {"radiance": np.ascontiguousarray(SAMPLES.transpose(1, 2, 0, 3))})


def test_a_reference_in_every_image_is_none_of_the_recording(tmp_path):
    """As a layer of samples it would make a recording that no method opens."""
    source = folder(tmp_path, [*"RGB", *(f"reference.{c}" for c in "RGB")], list(np.concatenate([SAMPLES, SAMPLES], axis=3)))
    code, message, path = imported(tmp_path, source)
    assert code == 0 and "not taken over: reference" in message, message
    with spool.open(path) as dump:
        assert list(dump.layers) == ["radiance"]
    path.unlink()
    code, message, path = imported(tmp_path, source, "map=reference=reference")
    assert code == 1 and "reference has a value for each sample" in message and not path.exists(), message


def test_files_that_are_no_samples_are_left_out_and_named(tmp_path):
    source = folder(tmp_path, "RGB", list(SAMPLES))
    (source / "._frame_003.exr").write_bytes(b"\0\5\x16\7")
    (source / "Thumbs.db").write_bytes(b"x")
    (source / "frame_007.exr").mkdir()
    code, message, path = imported(tmp_path, source)
    assert code == 0 and "not read (hidden, a folder, or no *.exr): ._frame_003.exr and 2 more" in message, message
    sample_dumps.assert_same(path, {"radiance": np.ascontiguousarray(SAMPLES.transpose(1, 2, 0, 3))})
    write_image(source / "thumbnail_003.exr", "RGB", SAMPLES[0][:2])
    (tmp_path / "a.spool").unlink()
    code, message, path = imported(tmp_path, source)
    assert code == 1 and "sample 3 is there twice, frame_003.exr and thumbnail_003.exr" in message, message


def damaged_folders(tmp_path):
    yield "no *.exr", (tmp_path / "empty", [])
    yield "no number in the name", (tmp_path / "name", [("one.exr", SAMPLES[0], {})])
    yield "sample 2 is missing", (tmp_path / "gap", [("a1.exr", SAMPLES[0], {}), ("a3.exr", SAMPLES[1], {})])
    yield "sample 2 is there twice, a02.exr and a2.exr", (tmp_path / "twice", [("a02.exr", SAMPLES[0], {}), ("a2.exr", SAMPLES[1], {})])
    yield "sample 0 is missing, a_-1.exr is followed by a_1.exr", (tmp_path / "zero", [("a_-1.exr", SAMPLES[0], {}), ("a_1.exr", SAMPLES[1], {})])
    yield "differ before their last 18 digits", (tmp_path / "long", [("a1%018d.exr" % 0, SAMPLES[0], {}), ("a2%018d.exr" % 0, SAMPLES[1], {})])
    yield "the seed did not change", (tmp_path / "same", [("a1.exr", SAMPLES[0], {}), ("a2.exr", SAMPLES[0], {})])
    yield "another data window", (tmp_path / "size", [("a1.exr", SAMPLES[0], {}), ("a2.exr", SAMPLES[1][1:], {})])
    yield "holds 16 samples", (tmp_path / "spp", [("a1.exr", SAMPLES[0], {"attributes": [("cycles.ViewLayer.samples", "16")]})])
    yield "chromaticities", (tmp_path / "colour", [("a1.exr", SAMPLES[0], {"attributes": [("chromaticities", None)]})])


def test_folders_that_are_no_record_are_refused(tmp_path):
    for words, (path, files) in damaged_folders(tmp_path):
        path.mkdir()
        for name, pixels, options in files:
            if options.get("attributes") == [("chromaticities", None)]:
                spec = oiio.ImageSpec(5, 6, 3, oiio.FLOAT)
                spec.attribute("chromaticities", oiio.TypeDesc("float[8]"), (0.7, 0.3, 0.1, 0.8, 0.1, 0.0, 0.32, 0.33))
                out = oiio.ImageOutput.create(str(path / name))
                assert out.open(str(path / name), spec) and out.write_image(pixels) and out.close()
            else:
                write_image(path / name, "RGB", pixels, **options)
        code, message = run_jobs(("import exr-folder", path, tmp_path / "a.spool"))[0]
        assert code == 1 and words in message, (words, message)
        assert not (tmp_path / "a.spool").exists()
    write_image(tmp_path / "gap" / "a2.exr", ["R", "G", "X"], SAMPLES[2])
    code, message = run_jobs(("import exr-folder", tmp_path / "gap", tmp_path / "a.spool"))[0]
    assert code == 1 and "other channels" in message

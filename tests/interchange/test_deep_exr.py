"""Deep EXR against OpenImageIO's own reader and writer."""
import numpy as np
import OpenImageIO as oiio
import pytest
import spool
import spool.exr

import exr_files
import sample_dumps
from conftest import run_jobs


def read_deep(path):
    image = oiio.ImageInput.open(str(path))
    spec = image.spec()
    return image.read_native_deep_image(), spec


def write_deep(path, channels, values, counts=None):
    """values [c][y][x][s] in float32, by OpenImageIO."""
    height, width, spp = values.shape[1:]
    spec = oiio.ImageSpec(width, height, len(channels), oiio.FLOAT)
    spec.channelnames, spec.deep = tuple(channels), True
    spec.attribute("compression", "zips")
    deep = oiio.DeepData()
    deep.init(width * height, len(channels), [oiio.TypeFloat] * len(channels), tuple(channels))
    for pixel in range(width * height):
        y, x = divmod(pixel, width)
        count = spp if counts is None else int(counts[y, x])
        deep.set_samples(pixel, count)
        for c in range(len(channels)):
            for s in range(count):
                deep.set_deep_value(pixel, c, s, float(values[c, y, x, s]))
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec) and out.write_deep_image(deep) and out.close()


@pytest.mark.parametrize("seed", range(6))
def test_every_layer_comes_back_bit_for_bit(tmp_path, seed):
    arrays = sample_dumps.rich(tmp_path / "a.spool", seed, size=(1 + seed, 9), spp=1 + 2 * seed)
    results = run_jobs(("export deep-exr", tmp_path / "a.spool", tmp_path / "a.exr"),
                       ("import deep-exr", tmp_path / "a.exr", tmp_path / "b.spool", "tile=16", "block=3"))
    assert [code for code, _ in results] == [0, 0], results
    names = sample_dumps.assert_same(tmp_path / "b.spool", arrays)
    assert names == set(arrays)
    with spool.open(tmp_path / "b.spool") as dump:
        assert dump.sample_order == "exchangeable" and dump.meta["renderer"] == {"name": "test"}


def test_openimageio_reads_the_same_samples(tmp_path):
    arrays = sample_dumps.rich(tmp_path / "a.spool", 3, finite=True)
    assert run_jobs(("export deep-exr", tmp_path / "a.spool", tmp_path / "a.exr"))[0][0] == 0
    deep, spec = read_deep(tmp_path / "a.exr")
    channels = list(spec.channelnames)
    assert {"radiance.R", "albedo.G", "depth.Z", "path.flags", "film.X", "Z", "spool.index"} <= set(channels)
    assert not {"A", "R", "ZBack"} & set(channels)
    for pixel, (y, x) in enumerate(np.ndindex(5, 9)):
        assert deep.samples(pixel) == 6
        for s in range(6):
            value = lambda name: deep.deep_value(pixel, channels.index(name), s)
            assert value("radiance.G") == arrays["radiance"][y, x, s, 1]
            assert value("albedo.B") == arrays["albedo"][y, x, s, 2]
            assert value("film.X") == arrays["film"][s, 0]
            assert value("Z") == s and deep.deep_value_uint(pixel, channels.index("spool.index"), s) == s


def test_reordered_samples_are_refused(tmp_path):
    sample_dumps.rich(tmp_path / "a.spool", 1, finite=True)
    run_jobs(("export deep-exr", tmp_path / "a.spool", tmp_path / "a.exr"))
    image = oiio.ImageInput.open(str(tmp_path / "a.exr"))
    spec, deep = image.spec(), image.read_native_deep_image()
    index = list(spec.channelnames).index("spool.index")
    deep.set_deep_value_uint(4, index, 2, 5)
    out = oiio.ImageOutput.create(str(tmp_path / "b.exr"))
    assert out.open(str(tmp_path / "b.exr"), spec) and out.write_deep_image(deep) and out.close()
    code, message = run_jobs(("import deep-exr", tmp_path / "b.exr", tmp_path / "b.spool"))[0]
    assert code == 1 and "sample 2 of pixel 4,0 has index 5: a tool reordered the samples" in message


def test_a_reference_of_another_recording_is_refused(tmp_path):
    for name in "ab":
        spool.write(tmp_path / f"{name}.spool", np.ones((3, 4, 2, 3), "f4"), reference=np.ones((3, 4, 3), "f4"))
        assert run_jobs(("export deep-exr", tmp_path / f"{name}.spool", tmp_path / f"{name}.exr"))[0][0] == 0
    pixels = spool.exr.read(tmp_path / "b.pixel.exr")
    (tmp_path / "b.pixel.exr").replace(tmp_path / "a.pixel.exr")
    code, message = run_jobs(("import deep-exr", tmp_path / "a.exr", tmp_path / "c.spool"))[0]
    assert code == 1 and message.startswith(f"{tmp_path / 'a.pixel.exr'}: of another recording than the samples"), message
    spool.exr.write(tmp_path / "b.pixel.exr", pixels)  # as exports of before: it is of no recording
    (tmp_path / "b.pixel.exr").replace(tmp_path / "a.pixel.exr")
    assert run_jobs(("import deep-exr", tmp_path / "a.exr", tmp_path / "c.spool"))[0][0] == 0


def test_a_layer_that_would_be_taken_for_the_numbers_of_samples_is_refused(tmp_path):
    values = np.arange(24, dtype="u4").reshape(3, 4, 2)
    spool.write(tmp_path / "a.spool", np.ones((3, 4, 2, 3), "f4"), spool=values, components={"spool": ["index"]})
    code, message = run_jobs(("export deep-exr", tmp_path / "a.spool", tmp_path / "a.exr"))[0]
    assert code == 1 and "layer spool has a component index" in message and not (tmp_path / "a.exr").exists(), message
    spool.write(tmp_path / "b.spool", np.ones((3, 4, 2, 3), "f4"), spook=values, components={"spook": ["index"]})
    assert run_jobs(("export deep-exr", tmp_path / "b.spool", tmp_path / "b.exr"))[0][0] == 0
    exr_files.edited(tmp_path / "b.exr", lambda name, value: value.replace("spook", "spool") if name == "spoolChannels" else value)
    code, message = run_jobs(("import deep-exr", tmp_path / "b.exr", tmp_path / "c.spool"))[0]
    assert code == 1 and "spool.index was lost in the export" in message, message


def test_files_of_other_tools(tmp_path):
    values = np.random.default_rng(1).random((4, 3, 5, 8), np.float32)
    values[3].sort(axis=-1)  # Z, as a tool would sort it
    write_deep(tmp_path / "a.exr", ["R", "G", "B", "Z"], values)
    refused, taken = run_jobs(("import deep-exr", tmp_path / "a.exr", tmp_path / "a.spool"),
                              ("import deep-exr", tmp_path / "a.exr", tmp_path / "a.spool", "deep_samples"))
    assert refused[0] == 2 and "import.deep_samples" in refused[1]
    assert taken[0] == 0 and "shuffled" in taken[1]
    with spool.open(tmp_path / "a.spool") as dump:
        assert dump.sample_order == "exchangeable"
        radiance, depth = dump.read("radiance"), dump.read("depth")[..., 0]
    first = []
    for y, x in np.ndindex(3, 5):
        order = np.argsort(depth[y, x], kind="stable")
        assert np.array_equal(depth[y, x][order], values[3, y, x])
        assert np.array_equal(radiance[y, x][order], values[:3, y, x].T)
        first.append(np.argmin(depth[y, x]))
    assert len(set(first)) > 3  # the nearest sample is not always the first


def test_samples_of_one_colour_are_remarked_as_nothing_tells_which_image_they_are_of(tmp_path):
    values = np.repeat(np.random.default_rng(1).random((4, 3, 5, 1), np.float32), 3, axis=-1)
    write_deep(tmp_path / "a.exr", ["R", "G", "B", "Z"], values)
    code, message = run_jobs(("import deep-exr", tmp_path / "a.exr", tmp_path / "a.spool", "deep_samples"))[0]
    assert code == 0 and "all 3 images are alike" in message, message
    with spool.open(tmp_path / "a.spool") as dump:
        assert "not independent" in " ".join(dump.meta["import_remarks"])


@pytest.mark.parametrize("channels, change, words", [
    (["R", "G", "B", "A", "Z"], "alpha", "as of compositing"),
    (["R", "G", "B", "Z", "ZBack"], "back", "as of compositing"),
    (["R", "G", "B"], "counts", "has 2 samples and pixel 0,0 has 3"),
    (["R", "G"], "", "no channel B")])
def test_what_is_no_sample_record_is_refused(tmp_path, channels, change, words):
    values = np.random.default_rng(1).random((len(channels), 2, 3, 3), np.float32)
    counts = np.full((2, 3), 3)
    if change == "counts":
        counts[1, 1] = 2
    if change == "back":
        values[4] = values[3] + 1
    write_deep(tmp_path / "a.exr", channels, values, counts)
    code, message = run_jobs(("import deep-exr", tmp_path / "a.exr", tmp_path / "a.spool", "deep_samples"))[0]
    assert code == 1 and words in message
    assert not (tmp_path / "a.spool").exists()

import hashlib

import numpy as np
import pytest
import spool

from sample_files import random_file


def test_worked_example_of_the_specification_has_its_hash(tmp_path):
    path = tmp_path / "example.spool"
    samples = np.array([[[[1, 0.5, 0]], [[2, 0.25, -0.0]]]], "f4")
    spool.write(path, samples, tile_size=8, block_spp=1, sample_order="exchangeable", uuid=bytes(range(16)))
    data = path.read_bytes()
    assert len(data) == 896
    assert hashlib.sha256(data).hexdigest() == "4a8fa69012ee082b93149433e666212b0bc41ac3dfbeefddb0d0838cd3beafd9"


@pytest.mark.parametrize("seed", range(150))
def test_every_block_comes_back_bit_for_bit(tmp_path, seed):
    rng = np.random.default_rng(seed)
    path = tmp_path / "random.spool"
    blocks, channels, uuid = random_file(path, rng, compress=bool(seed % 2), complete=seed % 5 != 0)
    with spool.open(path) as dump:
        assert dump.channels == channels and dump.uuid == uuid
        assert dump.blocks() == list(blocks)
        for key, block in blocks.items():
            found = dump.block(*key)
            assert found.dtype == block.dtype and found.shape == block.shape
            assert found.tobytes() == block.tobytes()
            assert not found.flags.writeable
        assert spool.check(path).ok


@pytest.mark.parametrize("seed", range(60))
def test_read_assembles_what_write_was_given(tmp_path, seed):
    rng = np.random.default_rng(seed)
    height, width, spp = (int(value) for value in rng.integers(1, 30, 3))
    radiance = rng.random((height, width, spp, 3), np.float32)
    depth = rng.random((height, width, spp), np.float32)
    film, reference = rng.random((spp, 2), np.float32), rng.random((height, width, 3), np.float32)
    path = tmp_path / "image.spool"
    spool.write(path, radiance, depth=depth, film=film, scope={"film": "pass"}, reference=reference,
                meta={"scene": "random"}, tile_size=8, block_spp=int(rng.integers(1, 9)), compress=bool(seed % 2))
    with spool.open(path) as dump:
        assert dump.complete and dump.meta == {"scene": "random"}
        assert (dump.read("radiance") == radiance).all()
        assert (dump.read("depth")[..., 0] == depth).all()
        assert (dump.passes("film") == film).all() and (dump.pixel("reference") == reference).all()
        for _ in range(10):
            x0, x1 = sorted(rng.choice(width + 1, 2, replace=False).tolist())
            y0, y1 = sorted(rng.choice(height + 1, 2, replace=False).tolist())
            first, last = sorted(rng.choice(spp + 1, 2, replace=False).tolist())
            part = dump.read("radiance", x0, y0, x1, y1, first, last - first)
            assert (part == radiance[y0:y1, x0:x1, first:last]).all()


def test_passes_of_any_number_make_the_same_file(tmp_path):
    rng = np.random.default_rng(3)
    radiance = rng.random((11, 13, 10, 3), np.float32)
    files = []
    for steps in ([10], [1] * 10, [3, 4, 3]):
        path = tmp_path / f"{len(files)}.spool"
        with spool.Writer(path, 13, 11, 10, {"radiance": ("f4", "RGB")}, tile_size=8, block_spp=4, uuid=bytes(16)) as writer:
            first = 0
            for count in steps:
                writer.write_passes(first, {"radiance": radiance[:, :, first:first + count]})
                first += count
        files.append(path.read_bytes())
    assert files[0] == files[1] == files[2]


def test_plain_blocks_are_views_of_the_file_and_outlive_the_dump(tmp_path):
    path = tmp_path / "view.spool"
    radiance = np.arange(8 * 8 * 2 * 3, dtype="f4").reshape(8, 8, 2, 3)
    spool.write(path, radiance)
    with spool.open(path) as dump:
        block = dump.block("radiance", 0, 0)
    assert not block.flags.owndata
    assert (block.transpose(1, 2, 3, 0) == radiance).all()


def test_layers_of_one_group_are_read_by_name(tmp_path):
    channels = [spool.Channel(f"radiance.{c}", 0, "<f4", 1) for c in "RGB"]
    channels += [spool.Channel(f"normal.{c}", 1, "<f2", 3) for c in "XYZ"] + [spool.Channel("depth.Z", 1, "<f2", 5)]
    rng = np.random.default_rng(5)
    arrays = {"radiance": rng.random((5, 6, 4, 3)), "normal": rng.random((5, 6, 4, 3)), "depth": rng.random((5, 6, 4))}
    path = tmp_path / "groups.spool"
    with spool.Writer(path, 6, 5, 4, channels=channels, tile_size=8, block_spp=3) as writer:
        writer.write_passes(0, arrays)
    with spool.open(path) as dump:
        assert (dump.read("normal") == arrays["normal"].astype("f2")).all()
        assert (dump.read("depth")[..., 0] == arrays["depth"].astype("f2")).all()


def test_missing_blocks_are_an_error_and_not_zeros(tmp_path):
    path = tmp_path / "short.spool"
    with spool.Writer(path, 16, 8, 4, {"radiance": ("f4", "RGB")}, tile_size=8, block_spp=2) as writer:
        writer.write_block("radiance", 0, 0, np.ones((3, 8, 8, 2), "f4"))
    with spool.open(path) as dump:
        assert not dump.complete and dump.has_block(0, 0, 0) and not dump.has_block(0, 1, 0)
        assert dump.read("radiance", x1=8, count=2).shape == (8, 8, 2, 3)
        with pytest.raises(spool.SpoolError) as caught:
            dump.read("radiance")
    assert caught.value.kind == "absent" and caught.value.code == 1
    assert spool.check(path).ok


@pytest.mark.parametrize("value", [-1, -1e-30, np.nan, np.inf])
def test_a_variance_that_is_none_is_refused_where_its_reference_judges(tmp_path, value):
    radiance, reference, variance = np.ones((4, 5, 2, 3), "f4"), np.ones((4, 5, 3), "f4"), np.zeros((4, 5, 3), "f4")
    variance[3, 2, 1] = value
    with pytest.raises(spool.SpoolError, match=r"a\.spool: reference_variance of pixel 2,3 is .*: a variance is finite and at least 0") as refused:
        spool.write(tmp_path / "a.spool", radiance, reference=reference, reference_variance=variance)
    assert refused.value.kind == "usage" and not list(tmp_path.iterdir())
    reference[3, 2, 1] = np.nan
    spool.write(tmp_path / "a.spool", radiance, reference=reference, reference_variance=variance)


@pytest.mark.parametrize("first", ["reference", "reference_variance"])
def test_a_streaming_writer_refuses_what_no_verb_opens(tmp_path, first):
    reference, variance = np.ones((8, 8, 3), "f4"), np.zeros((8, 8, 3), "f4")
    variance[3, 2, 1], reference[0, 0] = np.nan, np.nan
    arrays, path = {"reference": reference, "reference_variance": variance}, tmp_path / "a.spool"
    last, = arrays.keys() - {first}
    layers = {"radiance": ("f4", "RGB"), **dict.fromkeys(arrays, ("f4", "RGB", "pixel"))}
    with spool.Writer(path, 8, 8, 2, layers) as writer:
        writer.write_passes(0, {"radiance": np.ones((8, 8, 2, 3), "f4")})
        writer.write_pixel(first, arrays[first])
        with pytest.raises(spool.SpoolError, match="reference_variance of pixel 2,3 is nan"):
            writer.write_pixel(last, arrays[last])
        (variance if last == "reference_variance" else reference)[3, 2, 1] = np.nan if last == "reference" else 0
        writer.write_pixel(last, arrays[last])
    assert spool.check(path).ok


def test_a_reference_without_a_finite_value_is_refused(tmp_path):
    with pytest.raises(spool.SpoolError, match=r"a\.spool: reference: no value is finite"):
        spool.write(tmp_path / "a.spool", np.ones((8, 8, 2, 3), "f4"), reference=np.full((8, 8, 3), np.inf))
    assert not list(tmp_path.iterdir())

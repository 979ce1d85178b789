"""A reference that holds samples of the pool is found by the random numbers they share, however small the share."""
import numpy as np
import pytest

import spool
from dumps.verify.shared_numbers import chosen_pixels, found_again, marks, repeated, shared_number_findings
from dumps.verify.verify import verify

SIZE = 32


def places(samples, seed):
    """Film positions as renderers draw them: multiples of 2^-23."""
    return (np.random.default_rng(seed).integers(0, 1 << 23, (SIZE, SIZE, samples, 2)) / (1 << 23)).astype("f4")


def counts(pool, reference):
    pixels = chosen_pixels(SIZE, SIZE)
    known = np.sort(marks(pool, (0, SIZE), pixels))
    looked = marks(reference, (0, SIZE), pixels)
    return {"pool": len(known), "pool_repeated": repeated(known), "reference": len(looked),
            "reference_repeated": found_again(looked, known)}


def failed(numbers):
    return [entry["name"] for entry in shared_number_findings({"random_numbers": numbers}) if entry["holds"] is False]


def test_a_share_of_one_sixty_fourth_is_found_and_none_is_none():
    pool, reference = places(16, 1), places(1024, 2)
    assert failed(counts(pool, reference)) == []
    reference[:, :, 500:516] = pool
    found = counts(pool, reference)
    assert found["reference_repeated"] == found["reference"] // 64 and failed(found) == ["numbers of the reference"]


def test_a_stream_that_another_pixel_repeats_is_found():
    pool, reference = places(16, 1), places(64, 2)
    reference[:, 1:, :16] = pool[:, :-1]            # of the neighbour
    assert failed(counts(pool, reference)) == ["numbers of the reference"]
    pool[16:, :] = pool[:16, :]
    assert failed(counts(pool, places(64, 2))) == ["numbers of the pool"]


def test_bands_of_rows_give_what_the_whole_picture_gives():
    film, pixels = places(4, 3), chosen_pixels(SIZE, SIZE)
    bands = [marks(film[first:first + 5], (first, min(first + 5, SIZE)), pixels) for first in range(0, SIZE, 5)]
    assert np.array_equal(np.concatenate(bands), marks(film, (0, SIZE), pixels))


@pytest.mark.parametrize("width, height", [(512, 512), (640, 480), (63, 65), (1, 1)])
def test_chosen_pixels_are_few_and_in_every_column(width, height):
    chosen = chosen_pixels(width, height)
    assert len(chosen) <= 4096 and chosen[-1] < width * height
    assert len(np.unique(chosen % width)) == width


def test_verification_reads_the_counts_from_the_dump(tmp_path):
    radiance = np.random.default_rng(4).lognormal(size=(SIZE, SIZE, 16, 3)).astype("f4")
    for again, names in ((0, set()), (16384 // 64, {"numbers of the reference"})):
        path = tmp_path / "dump.spool"
        with spool.Writer(path, SIZE, SIZE, 16, {"radiance": ("f4", "RGB")}, sample_order="exchangeable", force=True, meta={
                "random_numbers": {"pool": 16384, "pool_repeated": 0, "reference": 16384, "reference_repeated": again}}) as writer:
            writer.write_passes(0, {"radiance": radiance})
        assert {e["name"] for e in verify(str(path))["findings"] if e["holds"] is False} == names


def test_a_black_picture_is_called_black_and_equal_samples_a_lost_seed(tmp_path):
    for value, words in ((0.0, "every sample is black"), (0.5, "one colour"), (None, "the seed did not reach")):
        radiance = np.full((SIZE, SIZE, 16, 3), value or 0, "f4")
        if value is None:
            radiance[:] = np.random.default_rng(5).random((SIZE, SIZE, 1, 3))
        path = tmp_path / "same.spool"
        with spool.Writer(path, SIZE, SIZE, 16, {"radiance": ("f4", "RGB")}, force=True) as writer:
            writer.write_passes(0, {"radiance": radiance})
        entry, = (e for e in verify(str(path))["findings"] if e["name"] == "samples differ")
        assert entry["holds"] is False and words in entry["note"]

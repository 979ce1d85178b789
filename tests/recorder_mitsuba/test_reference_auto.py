"""A reference that ends by itself, in bands of rows: drawn from numpy, and once by the recorder."""
import types

import numpy as np
import pytest

import spool
from conftest import check_ok, record
from dumps.mitsuba.plan import Cut
from dumps.mitsuba.reference import add_chunk, begun_or_empty, is_left_out, judged, left_out, told_of, variance_of_mean
from dumps.recording.reference_need import DENOMINATOR, denominator_noise

WIDTH, HEIGHT, MOST = 8, 40, 4096


def drawn(parts, state, until):
    """The state after `until` chunks; the lower rows are 30 times as noisy."""
    for part in parts[int(state["chunks"]):until]:
        index, (_, count, rows) = int(state["chunks"]), part
        state = judged(state, part)
        if is_left_out(state):
            state = left_out(state, part)
            continue
        light = np.random.default_rng(index).exponential(1.0, (rows[1] - rows[0], WIDTH, count, 3))
        noise = np.where(np.arange(*rows) < 16, 1.0, 30.0)[:, None, None, None]
        state = add_chunk(state, (1 + noise * (light - 1)).astype("f4"), 1.0, rows)
    return state


def cut_of(most):
    return Cut(types.SimpleNamespace(width=WIDTH, height=HEIGHT), most, 16 * WIDTH * 200, auto=True)


def test_bands_are_low_and_chunks_divide_where_it_is_judged():
    cut = cut_of(MOST)
    assert cut.bands == [(0, 16), (16, 32), (32, 40)] and cut.step == 128


def test_a_quiet_band_ends_early_and_a_noisy_one_goes_on():
    parts = cut_of(MOST).parts
    state = drawn(parts, begun_or_empty(None, MOST, parts, HEIGHT, WIDTH)[0], len(parts))
    count = state["count"][..., 0]
    assert (count[:16] == 512).all() and (count[16:] == MOST).all()
    assert list(state["ended"]) == [True, False, False]
    told = told_of(state)
    assert (told["samples_least"], told["samples_most"], told["samples"]) == (512, MOST, round(float(count.mean())))
    quiet = denominator_noise(state["mean"][:16], variance_of_mean(state)[:16])
    assert quiet <= DENOMINATOR < told["denominator_noise"]


def test_it_goes_on_to_the_same_bits_and_to_a_larger_most():
    parts = cut_of(MOST).parts
    empty = begun_or_empty(None, MOST, parts, HEIGHT, WIDTH)[0]
    whole = drawn(parts, empty, len(parts))
    part = drawn(parts, empty, 41)                       # the quiet band has ended
    again, useless = begun_or_empty(part, MOST, parts, HEIGHT, WIDTH)
    assert not useless and int(again["left_out"]) > 0
    again = drawn(parts, again, len(parts))
    assert all(np.array_equal(again[name], whole[name]) for name in ("count", "mean", "m2", "ended"))
    more = cut_of(2 * MOST).parts
    longer, useless = begun_or_empty(whole, 2 * MOST, more, HEIGHT, WIDTH)
    assert not useless
    longer = drawn(more, longer, len(more))
    assert longer["count"].max() == 2 * MOST and (longer["count"][:16] == 512).all()


def test_the_recorder_says_what_became_of_it(tmp_path):
    pytest.importorskip("mitsuba", reason="MITSUBA IS NOT INSTALLED: its recorder is NOT tested")
    out = tmp_path / "auto.spool"
    done = check_ok(record("cornell-box", "--size", "16x20", "--samples", 8, "--reference", "auto:1024", "--channels", "radiance", "-o", out))
    assert "samples a pixel; the noise of relMSE's denominator is" in done.stderr
    with spool.open(out) as dump:
        reference = dump.meta["reference"]
        noise = denominator_noise(dump.pixel("reference").astype(float), dump.pixel("reference_variance").astype(float))
    assert reference["samples_least"] >= 512 and reference["samples_most"] <= 1024
    assert noise == pytest.approx(reference["denominator_noise"], rel=1e-3)

"""When a reference is long enough: pure functions, and lines that are bounded."""
import numpy as np
import pytest

import spool
from dumps.recording.failure import Failure
from dumps.recording.reference_need import DENOMINATOR, EPSILON, LEAST, denominator_noise, judged_at, outcome, parse_reference


@pytest.mark.parametrize("text, number, auto", [("0", 0, False), ("4096", 4096, False), ("auto", 16384, True), ("auto:5000", 4096, True)])
def test_what_a_wish_means(text, number, auto):
    assert parse_reference(text) == (number, auto)


@pytest.mark.parametrize("text", ["", "x", "-1", "auto:", "auto:511", "auto:x", "1.5", "²", "99999999999", "auto:99999999999", "automatic"])
def test_a_wish_that_is_none_is_refused(text):
    with pytest.raises(Failure) as caught:
        parse_reference(text)
    assert caught.value.code == 2 and "--reference %s" % text in str(caught.value)


def test_it_is_judged_where_the_number_doubles():
    assert [n for n in range(0, 5000, 128) if judged_at(n)] == [LEAST, 2 * LEAST, 4 * LEAST, 8 * LEAST]


def test_the_noise_is_that_of_decision_156():
    mean, variance = np.array([[1.0, 0.0]]), np.array([[0.01, 0.001]])
    assert denominator_noise(mean, variance) == pytest.approx((0.01 / (1 + EPSILON) + 0.001 / EPSILON) / 2)
    told = {"samples": 700, "samples_least": 512, "samples_most": 1024, "denominator_noise": 2 * DENOMINATOR}
    assert len(outcome(told, 2048)) == 1 and "512 to 1024, 700 in the mean" in outcome(told, 2048)[0]
    assert "--reference auto:4096 goes on" in outcome(told, 1024)[1]


def test_lines_of_errors_are_bounded_and_keep_both_ends():
    for raised in (Failure(1, "a.xml: %s: do that" % ("x" * 100000)), spool.SpoolError("data", "a.spool: %s\n: do that" % ("y" * 100000))):
        text = str(raised)
        assert len(text) <= 380 and text.startswith("a.") and text.endswith(": do that") and "\n" not in text
    assert len(spool.SpoolError("data", "z" * 1000).message) <= 380

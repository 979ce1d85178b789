import math

import pytest
from made_results import make_row, make_rows, write_results

from aggregate import aggregate, guard_counts
from failure import Failure
from intervals import mean_interval
from results_table import read_results
from summary import contest, summarise, verdicts


def combinations_of(tmp_path, rows):
    write_results(tmp_path, rows)
    return aggregate(read_results(tmp_path / "results.csv"))


def sentences_of(combinations):
    return [s.text for s in summarise(combinations, "relmse", {c.dump: "chess" for c in combinations})]


def one_scene(**options):
    return make_rows(dumps=("chess.spool",), budgets=(8,), **options)


def test_means_and_intervals_are_those_of_the_rows(tmp_path):
    rows = make_rows()
    for combination in combinations_of(tmp_path, rows):
        values = [float(r["relmse"]) for r in rows
                  if (r["dump"], r["sampler"], r["filter"], float(r["spp"])) ==
                  (combination.dump, combination.sampler, combination.filter, combination.spp)]
        assert len(values) == 5
        assert combination.quantities["relmse"] == mean_interval(values)


def test_a_clear_difference_is_said_with_its_ratio(tmp_path):
    text = " ".join(sentences_of(combinations_of(tmp_path, one_scene(noise=0.005))))
    assert "multiscale + directional has the lowest error" in text
    assert "times the error of uniform + box" in text and "0.17" in text


def test_a_tie_is_said_to_be_one(tmp_path):
    rows = one_scene(samplers=("uniform", "mitchell"), filters=("box", "gaussian"), noise=0.05,
                     factor={"uniform": 1.0, "mitchell": 1.0, "box": 1.0, "gaussian": 1.0})
    text = " ".join(sentences_of(combinations_of(tmp_path, rows)))
    assert "no difference is resolved between the 4 combinations" in text
    assert "lowest" not in text and "times the" not in text


def test_what_ties_with_the_best_is_named(tmp_path):
    rows = one_scene(samplers=("uniform", "mitchell"), filters=("box", "gaussian"), noise=0.02)
    text = " ".join(sentences_of(combinations_of(tmp_path, rows)))
    first, second = "uniform + gaussian", "mitchell + gaussian"
    assert (f"{first} has the smallest mean" in text and f"not told apart from {second}" in text) or (
        f"{second} has the smallest mean" in text and f"not told apart from {first}" in text)
    assert "times the error of uniform + box" in text


def test_a_ratio_that_only_one_comparison_resolves_says_which_one(tmp_path):
    """uniform + box is undecided among five rivals together, and clearly worse when asked for alone."""
    errors = {"uniform": (1.162, 1.189, 0.603, 0.770, 1.032), "multiscale": (0.188, 0.154, 0.177, 0.174, 0.176)}
    errors.update({f"rival{n}": [2.0 + n + 0.01 * r for r in (3, 1, 4, 2, 5)] for n in range(4)})
    rows = [make_row("a.spool", sampler, "box", 8, replicate, error)
            for sampler, values in errors.items() for replicate, error in enumerate(values)]
    text = " ".join(sentences_of(combinations_of(tmp_path, rows)))
    assert "not told apart from uniform + box" in text
    assert "; compared with uniform + box alone, it has 0.18" in text and "not resolved" not in text


def test_equal_methods_are_called_different_at_most_five_times_of_a_hundred(tmp_path):
    equal = {"uniform": 1.0, "mitchell": 1.0, "box": 1.0, "gaussian": 1.0, "directional": 1.0}
    trials, claims = 300, 0
    for seed in range(trials):
        rows = one_scene(samplers=("uniform", "mitchell"), factor=equal, noise=0.1, seed=seed)
        claims += not contest(combinations_of(tmp_path, rows), "relmse").undecided
    # The best of six is only ever told apart from all others by chance.
    assert claims <= 0.05 * trials


def test_one_replicate_claims_nothing(tmp_path):
    text = " ".join(sentences_of(combinations_of(tmp_path, one_scene(replicates=1))))
    assert "nothing can be said about differences" in text and "lowest" not in text


def test_replicates_that_repeat_each_other_claim_nothing(tmp_path):
    rows = [make_row("a.spool", sampler, "box", 8, r, error)
            for sampler, error in (("uniform", 0.2), ("multiscale", 0.1)) for r in range(5)]
    for row in rows:
        row["energy_ratio"] = row["energy_ratio_d1"] = "1"
    combinations = combinations_of(tmp_path, rows)
    text = " ".join(sentences_of(combinations))
    assert all(c.alike for c in combinations)
    assert "nothing can be said about differences" in text and "repeat each other" in text
    assert not math.isfinite(combinations[1].quantities["relmse_ratio"].low)


def test_a_repeated_combination_is_not_compared_even_beside_others(tmp_path):
    rows = [make_row("a.spool", sampler, "box", 8, r, error + noise * r)
            for sampler, error, noise in (("uniform", 0.2, 0.0), ("multiscale", 0.1, 0.0), ("mitchell", 0.3, 1e-3))
            for r in range(5)]
    for row in rows:
        row["energy_ratio"] = row["energy_ratio_d1"] = "1"
    outcome = contest(combinations_of(tmp_path, rows), "relmse")
    assert outcome.best.sampler == "multiscale"
    assert [c.sampler for c in outcome.undecided] == ["uniform", "mitchell"]


def test_lost_energy_saturation_and_biased_references_are_said(tmp_path):
    rows = one_scene(noise=0.01)
    for row in rows:
        row["reference"] = "pool (biased)"
        if row["sampler"] == "mitchell":
            row["saturated_share"] = "0.2"
    text = " ".join(sentences_of(combinations_of(tmp_path, rows)))
    assert "loses 3.0 %" in text
    assert "20.0 %" in text and "longer recording" in text
    assert "Do not compare methods" in text


def test_failed_results_are_counted_and_left_out(tmp_path):
    rows = one_scene()
    bad = next(r for r in rows if r["sampler"] == "multiscale" and r["filter"] == "box")
    for name in list(bad)[6:]:
        bad[name] = ""
    bad["error"] = "not enough samples"
    combinations = combinations_of(tmp_path, rows)
    failed = [c for c in combinations if c.failures]
    assert [c.method for c in failed] == ["multiscale + box"]
    assert failed[0].quantities["relmse"].n == 4
    assert any("1 result failed" in s and "not enough samples" in s for s in sentences_of(combinations))


def test_verdicts_count_recordings(tmp_path):
    table = verdicts(combinations_of(tmp_path, make_rows(noise=0.005)), "relmse")
    verdict = table["multiscale + gaussian", 8.0]
    assert (verdict.better, verdict.worse, verdict.undecided) == (2, 0, 0)
    assert verdict.ratio == pytest.approx(0.35, rel=0.02)
    assert ("uniform + box", 8.0) not in table


def test_errors_at_the_noise_of_the_reference_are_said(tmp_path):
    rows = [make_row("a.spool", "uniform", "box", 8, r, e) for r, e in enumerate((-1e-4, 2e-4, -5e-5))]
    combinations = combinations_of(tmp_path, rows)
    assert any("noise of the reference" in s for s in sentences_of(combinations))


def test_guards_are_parsed():
    assert list(guard_counts("variance_floor=4 saturated_pieces=12")) == [("variance_floor", 4), ("saturated_pieces", 12)]
    assert list(guard_counts("")) == []


@pytest.mark.parametrize("change, message", [
    (lambda text: text.replace("relmse,", "relmse;", 1), "fields"),
    (lambda text: text.replace("sampler,", "sampled,", 1), "no column sampler"),
    (lambda text: text + text.splitlines()[1] + "\n", "repeats"),
    (lambda text: text.replace(",8,", ",eight,", 1), "no number"),
    (lambda text: text.replace(",8,", ",nan,", 1), "'nan' is no number"),
    (lambda text: text.replace(",8,", ",inf,", 1), "'inf' is no number"),
    (lambda text: text.replace(",8,", ",-8,", 1), "'-8' is no number"),
    (lambda text: text.replace(",8,", ",,", 1), "column spp"),
    (lambda text: text.splitlines()[0] + "\n", "no results"),
    (lambda text: "", "no column"),
])
def test_tables_that_cannot_be_right_are_refused_in_one_line(tmp_path, change, message):
    write_results(tmp_path, one_scene())
    path = tmp_path / "results.csv"
    path.write_text(change(path.read_text()))
    with pytest.raises(Failure, match=message) as failure:
        read_results(path)
    assert "\n" not in str(failure.value) and "results.csv" in str(failure.value)

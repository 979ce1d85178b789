import json

import pytest
from made_results import make_row, make_rows, write_results
from made_statistics import made_interval

from tools.report.aggregate import aggregate, guard_counts
from tools.report.failure import Failure
from tools.report.results_table import read_results
from tools.report.number_text import percent_text
from tools.report.statistics_file import best_is_alone, read_statistics
from tools.report.statistics_section import statistics_html
from tools.report.summary import leading, summarise, verdicts


def read(tmp_path, rows, change=None):
    write_results(tmp_path, rows)
    if change:
        path = tmp_path / "statistics.json"
        data = json.loads(path.read_text())
        change(data)
        path.write_text(json.dumps(data))
    statistics = read_statistics(tmp_path)
    return aggregate(read_results(tmp_path / "results.csv"), statistics), statistics


def sentences_of(tmp_path, rows, change=None):
    combinations, statistics = read(tmp_path, rows, change)
    found = summarise(combinations, statistics, "relmse", {c.dump: "chess" for c in combinations})
    return " ".join(s.text for s in found)


def one_scene(**options):
    return make_rows(dumps=("chess.spool",), budgets=(8,), **options)


def test_means_and_intervals_are_those_of_the_file(tmp_path):
    rows = make_rows()
    for combination in read(tmp_path, rows)[0]:
        values = [float(r["relmse"]) for r in rows
                  if (r["dump"], r["sampler"], r["filter"], float(r["spp"])) == combination.key[0:1] + (
                      combination.sampler, combination.filter, combination.spp)]
        assert len(values) == 5
        assert list(combination.quantity("relmse")) == made_interval(values)


def test_a_clear_difference_is_said_with_its_ratio(tmp_path):
    text = sentences_of(tmp_path, one_scene(noise=0.005))
    assert "multiscale + directional has the lowest error" in text
    assert "times the error of uniform + box" in text and "0.17" in text


def test_scenes_where_nothing_is_compared_are_not_counted(tmp_path):
    def void(data):
        for condition in data["conditions"]:
            for entry in condition["ranking"] if condition["dump"] == "dump0.spool" else ():
                entry.update(compared=False, value=[0.0, 0.0, 0.0])
    names = [f"dump{i}.spool" for i in range(5)]
    combinations, statistics = read(tmp_path, make_rows(dumps=names, budgets=(8,), noise=0.005), void)
    found = leading(summarise(combinations, statistics, "relmse", {n: n for n in names}), statistics, "relmse", 8)
    assert ["comes first on 4 of 4 scenes where methods are compared, and" in s.text for s in found if s.kind == "finding"] == [True]


def test_a_tie_is_said_to_be_one(tmp_path):
    rows = one_scene(samplers=("uniform", "mitchell"), filters=("box", "gaussian"), noise=0.005,
                     factor={"uniform": 1.0, "mitchell": 1.0, "box": 1.0, "gaussian": 1.0})
    text = sentences_of(tmp_path, rows)
    assert "comes first" in text and text.split("not separated from ")[1].split(".")[0].count(" + ") == 3
    assert "lowest" not in text and "times the" not in text


def test_what_ties_with_the_best_is_named(tmp_path):
    rows = one_scene(samplers=("uniform", "mitchell"), filters=("box", "gaussian"), noise=0.005)
    text = sentences_of(tmp_path, rows)
    first, second = "uniform + gaussian", "mitchell + gaussian"
    assert (f"{first} comes first" in text and f"not separated from {second}" in text) or (
        f"{second} comes first" in text and f"not separated from {first}" in text)
    assert "times the error of uniform + box" in text


def test_a_sentence_says_the_verdict_of_the_file_whatever_the_figures(tmp_path):
    def forget(data):
        for condition in data["conditions"]:
            for entry in condition["ranking"]:
                for key in ("against_best", "against_baseline"):
                    if key in entry:
                        entry[key] = "undecided"
    text = sentences_of(tmp_path, one_scene(noise=0.005), forget)
    assert "; not separated from" in text and "and 3 more." in text and "lowest" not in text and "times the error" not in text


@pytest.mark.parametrize("word, words", [("better", "worse than"), ("worse", "better than"), ("identical", "identical to"),
                                         ("not compared", "not compared with")])
def test_a_sentence_has_the_word_of_the_file(tmp_path, word, words):
    def change(data):
        for condition in data["conditions"]:
            condition["ranking"][1]["against_best"] = "undecided"
            condition["ranking"][2]["against_best"] = word
    rows = one_scene(samplers=("uniform",))
    text = sentences_of(tmp_path, rows, change)
    assert "comes first" in text and "not separated from uniform + gaussian" in text
    assert f"; {words} uniform + box" in text


@pytest.mark.parametrize("mean, lowest", [(0.5, False), (2.0, True)])
def test_nothing_is_the_best_where_a_mean_without_verdict_is_smaller(tmp_path, mean, lowest):
    def withhold(data):
        for condition in data["conditions"]:
            first, last = condition["ranking"][0], condition["ranking"][-1]
            last.update(compared=False, withheld="few pixels", value=[mean * first["value"][0]], letters="", against_baseline="not compared")
            del last["against_best"]
            for entry in condition["ranking"][1:-1]:
                entry["against_best"] = "worse"
    text = sentences_of(tmp_path, one_scene(noise=0.005), withhold)
    assert ("has the lowest error" in text) == lowest and text.count("not compared with uniform + box") == 1
    _, statistics = read(tmp_path, one_scene(noise=0.005), withhold)
    assert [best_is_alone(c) for c in statistics.of_metric("relmse")] == [lowest]


def test_without_results_of_a_baseline_nothing_is_relative_to_it(tmp_path):
    rows = one_scene(samplers=("mitchell", "multiscale"), filters=("box", "gaussian"))
    _, statistics = read(tmp_path, rows)
    html = statistics_html(statistics, {"chess.spool": "chess"}, "relmse")
    assert statistics.baseline == "" and "uniform" not in html and "relative" not in html and "mitchell + box" in html
    assert "relative to uniform + box" in statistics_html(read(tmp_path, one_scene())[1], {"chess.spool": "chess"}, "relmse")


def test_why_the_baseline_gives_no_verdict_stands_beside_it(tmp_path):
    def withhold(data):
        data["conditions"][0]["ranking"][0].update(against_baseline="not compared", baseline_withheld="few pixels")
    html = statistics_html(read(tmp_path, one_scene(), withhold)[1], {"chess.spool": "chess"}, "relmse")
    assert html.count("<td>not compared<small>of the baseline: few pixels</small></td>") == 1


def test_what_verdicts_are_about_names_its_places_where_it_differs(tmp_path):
    def change(data):
        for condition in data["conditions"]:
            condition["about"]["text"] = f"recording {condition['dump'][:1]}"
    combinations, statistics = read(tmp_path, make_rows(dumps=("a.spool", "b.spool"), budgets=(4, 8)), change)
    said = [s.text for s in summarise(combinations, statistics, "relmse", statistics.labels()) if s.kind == "about"]
    assert said == [f"Intervals and verdicts of {x} at 4 spp and {x} at 8 spp are about recording {x}." for x in "ab"]


def test_one_replicate_claims_nothing(tmp_path):
    text = sentences_of(tmp_path, one_scene(replicates=1))
    assert "nothing can be said about differences" in text and "lowest" not in text


def test_what_the_verdicts_are_about_is_said_once(tmp_path):
    assert sentences_of(tmp_path, one_scene()).count("Intervals and verdicts are about a made recording.") == 1


def test_a_repeated_combination_is_not_compared_even_beside_others(tmp_path):
    rows = [make_row("a.spool", sampler, "box", 8, r, error + noise * r)
            for sampler, error, noise in (("uniform", 0.2, 1e-3), ("multiscale", 0.1, 0.0), ("mitchell", 0.3, 1e-3))
            for r in range(5)]
    text = sentences_of(tmp_path, rows)
    assert "uniform + box comes first" in text and "not compared with multiscale + box" in text and "are one image" in text


def test_what_one_replicate_finished_is_no_repetition_of_one_image(tmp_path):
    rows = one_scene(filters=("box", "gaussian"))
    for row in rows:
        if row["filter"] == "gaussian" and row["replicate"] != "0":
            row.update({name: "" for name in list(row)[6:]}, error="out of luck")
    text = sentences_of(tmp_path, rows)
    assert "12 results failed" in text and "are one image" not in text


def test_lost_energy_saturation_and_biased_references_are_said(tmp_path):
    rows = one_scene(noise=0.01)
    for row in rows:
        row["reference"] = "pool (biased)"
        if row["sampler"] == "mitchell":
            row["saturated_share"] = "0.2"
        if row["sampler"] == "multiscale":
            row["energy_ratio"] = "0.94"
    text = sentences_of(tmp_path, rows)
    assert "loses 6.0 %" in text and "(it loses 6 % of the energy)" in text
    assert [percent_text(share) for share in (1.0, 0.999, 0.0234, 0.5)] == ["100 %", "100 %", "2.3 %", "50 %"]
    assert "20.0 %" in text and "longer recording" in text
    assert "relMSE (biased)" in text and "lowest" not in text


@pytest.mark.parametrize("half, said", [(0.4, "1 pixel bears half"), (7.2, "7 pixels bear half")])
def test_few_pixels_are_counted(tmp_path, half, said):
    def change(data):
        data["results"][0]["quantities"].update(relmse_half_pixels=[half], relmse_worst_share=[0.9])
    text = sentences_of(tmp_path, one_scene(), change)
    assert said in text and "1 result stands on few pixels" in text


def test_failed_results_are_counted_and_left_out(tmp_path):
    rows = one_scene()
    bad = next(r for r in rows if r["sampler"] == "multiscale" and r["filter"] == "box")
    for name in list(bad)[6:]:
        bad[name] = ""
    bad["error"] = "not enough samples"
    combinations, _ = read(tmp_path, rows)
    failed = [c for c in combinations if c.failures]
    assert [c.method for c in failed] == ["multiscale + box"]
    assert len(failed[0].rows) == 4
    text = sentences_of(tmp_path, rows)
    assert "1 result failed" in text and "not enough samples" in text


def test_verdicts_count_scenes(tmp_path):
    table = verdicts(read(tmp_path, make_rows(noise=0.005))[1], "relmse")
    verdict = table["multiscale + gaussian", 8.0]
    assert verdict.said == {"better": 2}
    assert verdict.ratio.mean == pytest.approx(0.35, rel=0.02)
    assert ("uniform + box", 8.0) not in table


def test_errors_that_are_not_resolved_are_said_without_a_cause(tmp_path):
    rows = [make_row("a.spool", "uniform", "box", 8, r, e) for r, e in enumerate((-1e-4, 2e-4, -5e-5))]
    def open_interval(data):
        data["results"][0]["quantities"]["relmse"] = [1e-5, 0.0, 1e-4]
    text = sentences_of(tmp_path, rows, open_interval)
    assert "reaches zero: the error is not resolved" in text and "noise of the reference" not in text


@pytest.mark.parametrize("change, message", [
    (lambda path: path.unlink(), "--statistics-only"),
    (lambda path: path.write_text("{"), "not JSON"),
    (lambda path: path.write_text('{"conditions": []}'), "another version"),
])
def test_without_its_statistics_there_is_no_report(tmp_path, change, message):
    write_results(tmp_path, one_scene())
    change(tmp_path / "statistics.json")
    with pytest.raises(Failure, match=message) as failure:
        read_statistics(tmp_path)
    assert "\n" not in str(failure.value) and "statistics.json" in str(failure.value)


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

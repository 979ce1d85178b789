"""Which methods `spool figure` shows, and what captions and tables say of them."""

import csv
import json
import re
import shutil
import subprocess

import pytest
from made_results import make_rows, write_images, write_results

pytest.importorskip("matplotlib", reason="SKIPPED: no matplotlib in this Python")

from tools.report import figure_set
from tools.report.draw_curves import read
from tools.report.failure import Failure
from tools.report.figure import main
from tools.report.figure_captions import notes, numbers_text
from tools.report.figure_methods import choose_methods, left_out_text, own_methods
from tools.report.figure_tables import latex_interval, plain_interval, ratio_number
from tools.report.figure_text import breakable
from tools.report.number_text import ratio_text
from tools.report.result_images import dump_names, file_name_of
from tools.report.statistics_file import Statistics, interval_of

HOSTILE = r"a_b%&#${x}~^\d"
DOCUMENT = r"""\documentclass[twocolumn]{article}
\usepackage[T1]{fontenc}\usepackage{graphicx,booktabs,tabularx}
\begin{document}\input{captions}\input{table}\end{document}"""


def condition(*names, baseline="uniform + box"):
    """Of one budget, best first."""
    ranking = []
    for name in names:
        sampler, filter_ = name.split(" + ")
        ranking.append({"sampler": sampler, "filter": filter_, **({} if name == baseline else {"against_baseline": "better"})})
    return {"ranking": ranking}


def results(*names):
    return [{"sampler": s, "filter": f, "sampler_name": s.split(":")[0], "filter_name": f.split(":")[0]}
            for s, f in (name.split(" + ") for name in names)]


OTHERS = [f"multiscale + f{i}" for i in range(6)]
BUILT_IN = frozenset(["uniform", "multiscale", "box", *(f"f{i}" for i in range(6))])


def test_own_methods_come_first_then_the_baseline_and_what_is_left_out_is_named():
    names = [*OTHERS, "uniform + box", "uniform + exec:./den", "mine + box"]
    own = own_methods(results(*names), BUILT_IN)
    assert own == {"uniform + exec:./den": ["exec:./den"], "mine + box": ["mine"]}
    chosen = choose_methods([], [condition(*names)], own)
    assert chosen == ["uniform + exec:./den", "mine + box", "uniform + box", "multiscale + f0", "multiscale + f1"]
    said = left_out_text(chosen, [condition(*names)])
    assert all(f"f{i}" in said for i in range(2, 6)) and "f1" not in said and "mine" not in said
    assert left_out_text(names, [condition(*names)]) == ""


def test_without_the_programs_list_commands_and_images_are_still_own():
    assert set(own_methods(results("python:f + box", "uniform + image:x.exr", "uniform + box"), frozenset())) == {
        "python:f + box", "uniform + image:x.exr"}


def test_each_own_name_is_shown_where_it_is_best_and_eight_methods_are_the_most():
    names = [f"mine + f{i}" for i in range(6)] + ["uniform + other", "uniform + box", "uniform + f0"]
    chosen = choose_methods([], [condition(*names)], own_methods(results(*names), BUILT_IN))
    assert len(chosen) == 8 and "uniform + other" in chosen and chosen[0] == "mine + f0"
    assert chosen[-2:] == ["uniform + box", "uniform + f0"]


@pytest.mark.parametrize("baseline", ["uniform + box", "multiscale + f2", ""])
def test_the_baseline_is_the_one_that_the_file_compares_the_others_with(baseline):
    chosen = choose_methods([], [condition(*OTHERS, "uniform + box", baseline=baseline)], {})
    assert (chosen[0] == baseline) if baseline else chosen == OTHERS[:5]


def test_labelled_methods_are_the_users_too():
    labelled = [{"sampler": s, "filter": "box", "sampler_name": "multiscale", "filter_name": "box"}
                for s in ("eager{alpha=0.8}", "multiscale:paper{alpha=0.8} [R]", "multiscale [2 threads]")]
    assert own_methods(labelled, BUILT_IN) == {"eager{alpha=0.8} + box": ["eager{alpha=0.8}"]}


def test_a_method_is_known_without_its_mark_and_an_error_names_whole_methods():
    names = [f"multiscale [R] + cross_bilateral{{sigma={i}}} [R]" for i in range(64)]
    assert choose_methods(["multiscale + cross_bilateral{sigma=7}"], [condition(*names)], {}) == [names[7]]
    with pytest.raises(Failure) as failure:
        choose_methods(["x" * 60], [condition(*names)], {})
    shown = str(failure.value)
    assert len(shown) < 400 and shown.endswith("[R]; and 59 more")


def test_a_method_that_only_another_recording_has_may_be_asked_for():
    conditions = [condition("uniform + box", "a + f"), condition("uniform + box", "b + f")]
    assert choose_methods(["b + f"], conditions, {}) == ["b + f"]
    with pytest.raises(Failure, match="room for 8"):
        choose_methods([f"m{i} + f" for i in range(9)], [condition(*(f"m{i} + f" for i in range(9)))], {})


def made(folder, claims=(), samplers=("uniform", HOSTILE, "exec:./den -x"), budgets=(4, 8)):
    rows = make_rows(dumps=("scenes/a.spool",), samplers=samplers, filters=("box", "directional"), budgets=budgets,
                     replicates=3, size=(20, 16))
    write_results(folder, rows)
    write_images(folder, rows, dump_names(["scenes/a.spool"]), file_name_of)
    data = json.loads((folder / "statistics.json").read_text())
    data["claims"] = list(claims)
    data["scenes"][0]["group"] = HOSTILE
    for entry in data["results"]:
        entry["sampler_name"], entry["filter_name"] = entry["sampler"].split(":")[0], entry["filter"]
    for entry in (e for c in data["conditions"] for e in c["ranking"] if e["sampler"] == HOSTILE):
        entry.update(withheld="few pixels", value=entry["value"][:1], ratio=entry["value"][:1])
    (folder / "statistics.json").write_text(json.dumps(data))
    return folder


CLAIM = {"text": f"{HOSTILE} halves the error", "better": "a", "than": "b", "metric": "relmse", "verdict": "not supported",
         "places": [{"dump": "scenes/a.spool", "spp": 8, "verdict": "contradicted", "ratio": [1.234, 1.111, 1.362]},
                    {"dump": "scenes/a.spool", "spp": 4, "verdict": "not compared", "ratio": [1.2],
                     "withheld": "few pixels"}], "after_results": True}


def test_captions_say_budget_replicates_and_intervals_and_claims_are_the_programs(tmp_path):
    assert main([str(made(tmp_path / "r", [CLAIM])), "-o", str(tmp_path / "f"), "--built-in=uniform,box,directional"]) == 0
    captions, tex, text = ((tmp_path / "f" / name).read_text() for name in ("captions.tex", "table.tex", "table.md"))
    for picture in re.findall(r"\{(\S+?\.pdf)\}", captions):
        assert (tmp_path / "f" / picture).exists()
    assert captions.count(r"\begin{figure") == 3 and "at 8 samples per pixel" in captions and "over 3 replicates" in captions
    plain = captions.replace(r"\allowbreak{}", "")
    assert plain.count("have the start of a command") == 1
    assert "Times of exec:./den -{}x + directional and exec:./den -{}x + box have the start of a command" in plain
    assert "contradicted & $1.23_{\\,1.11}^{\\,1.36}$" in tex and "(added after results)" in tex
    assert "4 spp & not compared: few pixels & $1.20$" in tex
    assert re.search(r"8 spp: contradicted 1\.23 ..1\.11, 1\.36", text) and "not supported" in text
    assert r"$\ddagger$: no verdict, and no interval of a ratio to it (few pixels)" in tex and tex.count(r"$\ddagger$") == 5
    assert "(a)" not in captions and "relmse" not in captions + tex + text


@pytest.mark.parametrize("reference", ["independent", "pool (biased)"])
def test_captions_tables_and_curves_say_what_judged_and_of_the_pool_that_it_is_biased(tmp_path, capsys, reference):
    folder = made(tmp_path / "r", [CLAIM], budgets=(4,))
    text = (folder / "statistics.json").read_text().replace('"independent"', f'"{reference}"')
    text = text.replace('"failed": 0', '"failed": 2', 1).replace('"biased": false', f'"biased": {json.dumps("biased" in reference)}')
    (folder / "statistics.json").write_text(text)
    assert main([str(folder), "-o", str(tmp_path / "f")]) == 0
    biased = "biased" in reference
    kind = "all samples" if biased else "an independent reference"
    out = capsys.readouterr().out
    assert out.endswith(f"Judged by {kind}. BIASED: errors are too small, and differently for each method.\n") == biased
    drawn = read(tmp_path / "f" / "curves.csv")[0][HOSTILE][f"{HOSTILE} + box"]
    assert all(low != low and high != high for _, _, low, high, _ in drawn)  # withheld: no bar
    for name, parts in (("captions.tex", 3), ("table.tex", 2), ("table.md", 1)):
        text = (tmp_path / "f" / name).read_text()
        assert text.count(f"Judged by {kind}.") == parts and text.count("BIASED") == parts * biased, name
        assert text.count("2 results failed and are left out.") == (1 if name == "table.tex" else parts)  # claims have none
        assert ("relMSE (biased)" in text) == biased and not (biased and re.search(r"mathbf|\*\*0", text))
    assert {row["metric"] for row in csv.DictReader((tmp_path / "f" / "curves.csv").open())} == {"relmse" + " (biased)" * biased}


@pytest.mark.skipif(not shutil.which("pdflatex"), reason="SKIPPED: no LaTeX")
def test_latex_takes_captions_and_tables_as_they_are_and_a_column_holds_them(tmp_path):
    folder = made(tmp_path / "r", [CLAIM] * 30, ("uniform", HOSTILE, "x" * 90, "multiscale:paper{alpha=0.3,epochs=4}"),
                  (4, 65536))  # powers of ten
    assert main([str(folder), "-o", str(tmp_path / "f"), "--column", "1"]) == 0
    assert "10^{-5}}_{" in (tmp_path / "f" / "table.tex").read_text()
    (tmp_path / "f" / "paper.tex").write_text(DOCUMENT)
    done = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "paper"], cwd=tmp_path / "f",
                          capture_output=True, text=True, errors="replace")
    log = (tmp_path / "f" / "paper.log").read_text(errors="replace")
    assert done.returncode == 0, done.stdout[-2000:]
    assert "Overfull" not in log and "too large" not in log, log[-3000:]


def test_a_table_of_many_methods_is_cut_into_parts(tmp_path, monkeypatch):
    monkeypatch.setattr(figure_set.FigureSet, "_curves", lambda *_: [])
    folder = made(tmp_path / "r", (), [f"m{i}" for i in range(60)])
    assert main([str(folder), "-o", str(tmp_path / "f"), "--method", "m0 + box", "--method", "m1 + box"]) == 0
    tex = (tmp_path / "f" / "table.tex").read_text()
    assert tex.count(r"\begin{table}") == 8 and "part 8 of 8" in tex  # of 240 rows
    assert sum(tex.count(f"m{i} + ") for i in range(60)) == 240


def test_letters_of_too_many_groups_are_left_out_and_that_is_said_once(tmp_path, monkeypatch):
    monkeypatch.setattr(figure_set.FigureSet, "_curves", lambda *_: [])
    folder = made(tmp_path / "r", (), [f"m{i}" for i in range(4)])
    path = folder / "statistics.json"
    data = json.loads(path.read_text())
    data["conditions"][0]["ranking"][3]["letters"] = "uvwxyza1b1c1d1e1"
    path.write_text(json.dumps(data))
    assert main([str(folder), "-o", str(tmp_path / "f"), "--method", "m0 + box"]) == 0
    tex, text = ((tmp_path / "f" / name).read_text() for name in ("table.tex", "table.md"))
    assert "a1b1" not in tex + text and text.count("too many groups") == tex.count("too many groups") == 1
    assert re.search(r"\| a \|", text)  # of the other budget


def test_one_sample_is_no_plural(tmp_path):
    assert main([str(made(tmp_path / "r", budgets=(1,))), "-o", str(tmp_path / "f")]) == 0
    for name in ("table.md", "captions.tex", "table.tex"):
        text = (tmp_path / "f" / name).read_text()
        assert "1 sample per pixel" in text and "1 samples" not in text


def test_the_largest_loss_of_light_is_told_and_what_is_widened_is_said_once():
    lost = {"sampler": "a", "filter": "b", "loses_energy": 0.05}
    shared = [{"about": {"kind": "shared", "text": f"another recording; replicates share {n} %"}, "ranking": [
        {**lost, "loses_energy": n / 100}, {"sampler": "c", "filter": "d"}]} for n in (14, 5)]
    assert notes(shared, ["a + b", "c + d"]) == r" Light is lost by a + b (up to 14 \%)."
    assert notes(shared[1:], ["a + b"]) == r" Light is lost by a + b (5 \%)." and notes(shared, ["c + d"]) == ""
    black = [{**shared[0], "ranking": [{**lost, "loses_energy": 1.0}]}]
    assert notes(black, ["a + b"]) == r" Light is lost by a + b (100 \%)."
    few = [{**shared[0], "ranking": [{"sampler": "c", "filter": "d", "withheld": "few pixels"}]}]
    assert notes(few, ["c + d"]) == " Means without an interval: withheld (few pixels)."
    said = numbers_text(Statistics({"scenes": [], "results": [{"replicates": 3, "failed": 0, "threads": 0, "reference": "holdout"}], "conditions": [],
                                    "curves": [], "overall": []}), "relmse", shared)
    assert "Judged by samples held out." in said
    assert said.count("another recording") == 1 and said.endswith("wider where replicates share samples.")


def test_names_break_after_marks_and_words_only_where_they_are_no_words():
    assert breakable("multiscale{a_b=1} + directional") == (
        r"multiscale\{\allowbreak{}a\_\allowbreak{}b=\allowbreak{}1\}\allowbreak{} + directional")
    assert breakable("x" * 21) == r"xxxxxxx\allowbreak{}xxxxxxx\allowbreak{}xxxxxxx" and breakable("") == ""


@pytest.mark.parametrize("ratio, words", [([1.0004, 1.0002, 1.0006], "1.0004 [1.0002, 1.001]"), ([0.99961, 0.9996, 0.99962], "0.9996 [0.9996, 0.9996]"),
                                          ([1.05, 1.003, 1.1], "1.05 [1.003, 1.1]"), ([1.0, 1.0, 1.0], "1 [1, 1]"), ([0.5], "0.5"), ([], "")])
def test_a_ratio_reads_one_only_where_it_is_one(ratio, words):
    """Beside "better" or a letter of its own, 1 [1, 1] would say the contrary."""
    assert ratio_text(interval_of(ratio)) == words
    padded = {"1": "1.00", "1.1": "1.10", "0.5": "0.500"}
    written = re.sub(r"[0-9.]+", lambda number: padded.get(number[0], number[0]), words)
    assert plain_interval(interval_of(ratio), ratio_number) == written
    assert re.findall(r"[0-9.]+", latex_interval(interval_of(ratio), number=ratio_number)) == re.findall(r"[0-9.]+", written)

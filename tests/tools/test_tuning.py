"""The choice of options: the pool left out takes no part, ties and misses by their stated rules, the plan of the judgement."""
import itertools
import math
import os
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/experiments"))
import tune  # noqa: E402
from inference import mean_of, order_of, ratio_of, use_program  # noqa: E402
from results import Results  # noqa: E402
from tuning_choice import Candidate, Choice, Scores  # noqa: E402
from tuning_page import alone_section, energy_misses, page, single_section, target_table  # noqa: E402
from tuning_pools import APART, CHOOSING, RECORDED, SECOND, recording  # noqa: E402
from tuning_verdict import MET, MISSED, NOISE, RIVALS, reasons, verdict  # noqa: E402

use_program(os.environ.get("SPOOL_PROGRAM", "spool"))

DEFAULTS = Candidate((), (), 0)
LARGE = Candidate((), (("size_factor", "const(1)"),), 1)
BOTH = Candidate((("init_spp", "2"),), (("size_factor", "const(1)"),), 2)
WOBBLE = [0.98, 1.0, 1.01, 0.99, 1.02]


def cell(error, energy=1.0, noise=WOBBLE):
    return [error * w for w in noise], [energy] * len(noise), [w for w in WOBBLE]


def cells(**pools):
    """cells(a=(error of each candidate), ...): one budget."""
    return {c: {p: [errors[i] if isinstance(errors[i], tuple) else cell(errors[i])] for p, errors in pools.items()}
            for i, c in enumerate((DEFAULTS, LARGE, BOTH))}


def test_the_pool_left_out_has_no_say():
    made = cells(a=(0.5, 0.4, 0.9), b=(0.5, 0.4, 0.9), c=(0.5, 400.0, 0.9))
    scores = Scores(made, "abc")
    assert scores.choose("abc").candidate == DEFAULTS  # c's own figures would flip it
    left_out = scores.leave_one_out("abc")
    assert left_out["c"].candidate == LARGE
    assert left_out["a"].candidate == left_out["b"].candidate == DEFAULTS


def test_no_figure_of_the_pool_left_out_reaches_its_choice():
    tame, wild = cells(a=(0.5, 0.4, 0.9), b=(0.5, 0.4, 0.9), c=(1, 1, 1)), cells(a=(0.5, 0.4, 0.9), b=(0.5, 0.4, 0.9), c=(1e6, 1, 1e-6))
    assert Scores(tame, "abc").leave_one_out("abc")["c"] == Scores(wild, "abc").leave_one_out("abc")["c"]


def test_the_score_is_a_mean_of_logarithms_with_a_price_on_energy():
    scores = Scores({DEFAULTS: {"a": [cell(0.5, 0.95), cell(0.25)], "b": [cell(1.0, 1.05), cell(1.0)]}}, "ab")
    a = (math.log(0.5) + 2 * 0.02 + math.log(0.25)) / 2
    assert scores.score(DEFAULTS, "a") == pytest.approx(a)
    assert scores.score(DEFAULTS, "ab") == pytest.approx((a + 0.02) / 2)


def test_energy_beyond_the_band_can_turn_the_choice():
    made = cells(a=(cell(0.40, 0.99), cell(0.38, 0.85), 0.9), b=(0.5, 0.5, 0.9))
    assert Scores(made, "ab").choose("ab").candidate == DEFAULTS
    assert Scores(made, "ab", energy_weight=0.0).choose("ab").candidate == LARGE


def test_of_candidates_level_within_the_noise_the_one_with_the_fewest_changes_is_taken():
    noisy = cell(0.49, noise=[0.7, 1.3, 1.0, 0.8, 1.2])
    choice = Scores(cells(a=(0.5, noisy, 0.9)), "a").choose("a")
    assert (choice.candidate, choice.best, choice.tied) == (DEFAULTS, LARGE, 2)
    clear = Scores(cells(a=(0.5, 0.45, 0.9)), "a").choose("a")
    assert (clear.candidate, clear.tied) == (LARGE, 1)


def test_of_equal_candidates_with_as_many_changes_the_first_of_the_plan_is_taken():
    other = Candidate((), (("sigma_max", "0.3"),), 0)
    made = {LARGE: {"a": [cell(0.5)]}, other: {"a": [cell(0.5)]}}
    assert Scores(made, "a").choose("a").candidate == other


def test_a_candidate_that_failed_somewhere_takes_no_part():
    made = cells(a=(0.5, 0.1, 0.9), b=(0.5, ([], [], []), 0.9))
    scores = Scores(made, "ab")
    assert scores.choose("ab").candidate == DEFAULTS and scores.incomplete == [LARGE]


def test_a_pool_is_judged_by_the_choice_in_which_its_scene_had_no_say():
    left_out = {p: Choice(Candidate((), (("pool", p),), 0), DEFAULTS, 1, 0.0, 0.0) for p in CHOOSING}
    chosen = tune.choices(left_out, Choice(BOTH, BOTH, 1, 0.0, 0.0))
    assert {p: dict(chosen[p].filter)["pool"] for p in [*CHOOSING, *SECOND]} == {p: p for p in CHOOSING} | SECOND
    assert all(chosen[p] == BOTH for p in APART) and len(chosen) == len(CHOOSING) + len(SECOND) + len(APART)


OURS = ("multiscale", "directional")
WORDS = {-1: "better", 1: "worse", 0: "undecided", None: "not compared"}


def judge(made):
    """Gives results the figures and verdicts that statistics.json would have for their rows."""
    by_place = {}
    for (pool, sampler, filter_name, spp, threads), rows in made._rows.items():
        made._figures[pool, sampler, filter_name, spp, threads] = {
            column: mean_of([row[column] for row in rows]) for column in rows[0] if column != "replicate"}
        by_place.setdefault((pool, spp, threads), []).append(((sampler, filter_name), [row["relmse"] for row in rows]))
    for place, methods in by_place.items():
        made._pairs[(*place, "relmse")] = {
            (a, b): (WORDS[order_of(x, y)], ratio_of(x, y)) for (a, x), (b, y) in itertools.combinations(methods, 2)}
    return made


@pytest.fixture
def results():
    made = Results([])

    def add(method, errors, energy=1.0, pool="p"):
        made._rows[(pool, *method, 8, 0)] = [
            {"replicate": r, "relmse": e, "energy_ratio": energy, "relmse_dropped": e / 4} for r, e in enumerate(errors)]
        judge(made)

    made.add = add
    for rival in RIVALS:
        add(rival, [2 * w for w in WOBBLE])
    return made


def test_the_target_is_met_at_or_below_every_rival_with_the_energy_kept(results):
    results.add(OURS, [2 * w for w in WOBBLE], 0.975)
    assert verdict(results, "p", 8, *OURS).word == MET and reasons(results, "p", 8, OURS) == []


def test_a_miss_against_one_rival_is_marked_with_its_reason(results):
    results.add(OURS, WOBBLE)
    results.add(RIVALS[0], [0.5 * w for w in WOBBLE])
    results.add((OURS[0], RIVALS[0][1]), [0.5 * w for w in WOBBLE])
    results.add((RIVALS[0][0], OURS[1]), [2 * w for w in WOBBLE])
    found = verdict(results, "p", 8, *OURS)
    assert found.rivals == (MISSED, MET, MET) and found.energy == MET and found.word == MISSED
    row = target_table(results, ["p"], {"p": OURS}, [8]).splitlines()[-1]
    assert "**missed** (relMSE)" in row and "**2.00" in row
    (rival, word, own, their_filter, their_samples, part, worst), = reasons(results, "p", 8, OURS)
    assert (rival, word, part, worst) == ("greedy_error + greedy_selection", MISSED, "the filter", "25 %")
    assert [x[:4] for x in (own, their_filter, their_samples)] == ["2.00", "1.00", "4.00"]


def test_a_mean_above_within_the_noise_is_a_miss_too_but_said_to_be_so(results):
    results.add(OURS, [2.6, 1.6, 2.4, 1.7, 2.2])
    assert verdict(results, "p", 8, *OURS).word == NOISE
    assert "*missed within the noise*" in target_table(results, ["p"], {"p": OURS}, [8])


def test_lost_energy_is_a_miss_whatever_the_error(results):
    results.add(OURS, WOBBLE, 0.9)
    results.add((OURS[0], "box"), WOBBLE, 0.92)
    assert verdict(results, "p", 8, *OURS).energy == MISSED
    assert reasons(results, "p", 8, OURS) == []
    assert "| p | 8 | 0.900 | -8.0 % | -2.0 % | nan |" in energy_misses(results, ["p"], {"p": OURS}, [8])
    assert energy_misses(results, ["p"], {"p": RIVALS[0]}, [8]) == "None."


def test_a_cell_that_is_missing_is_not_called_met(results):
    found = verdict(results, "p", 8, *OURS)
    assert {*found.rivals, found.energy} == {"not measured"} == {found.word}


def test_pools_kept_apart_and_second_recordings_never_choose():
    assert not set(CHOOSING) & (set(APART) | set(SECOND)) and set(SECOND.values()) <= set(CHOOSING)
    plan = tomllib.loads((ROOT / "tools/plans/tuning.toml").read_text())
    assert [Path(r).stem for r in plan["recordings"]] == CHOOSING and plan["spp"] == tune.BUDGETS
    recorded = tomllib.loads((ROOT / "dumps/CATALOG.toml").read_text())["recording"]
    assert sorted(r["name"] for r in recorded) == RECORDED, "a recording of the tree that the target is not checked on"


def test_a_default_written_out_is_no_other_candidate():
    manifest = {"plan": {
        "samplers": [{"name": "multiscale", "preset": "robust", "label": f"multiscale{t}", "options": {"alpha": "0.4"}} for t in ("", "{alpha=0.4}")],
        "filters": [{"name": "directional", "preset": "robust", "label": f"directional{{rho={v}}}", "options": {"rho": v}} for v in ("0.1", "0.2")]}}
    results = Results([])
    results._rows["balls", "uniform", "box", 4, 0] = []
    made = tune.candidate_cells(results, manifest, {"samplers": {"alpha": "0.4"}, "filters": {"rho": "0.1"}})
    assert [(c.sampler, c.filter) for c in made] == [((), ()), ((), (("rho", "0.2"),))]
    with pytest.raises(SystemExit, match="lacks the defaults"):
        tune.candidate_cells(results, manifest, {"samplers": {"alpha": "0.4"}, "filters": {"rho": "0.3"}})


def test_the_plan_of_the_judgement_has_the_choice_the_defaults_and_every_rival(tmp_path):
    plan = tomllib.loads(tune.judging_plan(["fireflies"], [BOTH, DEFAULTS], tmp_path))
    assert (tmp_path / plan["recordings"][0]).resolve() == ROOT / recording("fireflies")
    assert plan["sampler"] == [{"name": "multiscale", "init_spp": "2"}, {"name": "multiscale"}]
    assert all(s in plan["samplers"] and f in plan["filters"] for s, f in RIVALS)
    assert [tune.methods(c) for c in tune.singles(BOTH)] == [
        OURS, ("multiscale{init_spp=2}", "directional"), ("multiscale", "directional{size_factor=const(1)}")]
    assert tune.methods(BOTH) == ("multiscale{init_spp=2}", "directional{size_factor=const(1)}")


def made_page(errors, without=(), apart=None):
    """The page where the candidates have these errors on every pool; some not judged."""
    made = {c: {p: [cell(e)] * 3 for p in CHOOSING} for c, e in zip((DEFAULTS, LARGE), errors)}
    scores, judged = Scores(made, CHOOSING), Results([])
    left_out, from_all = scores.leave_one_out(CHOOSING), scores.choose(CHOOSING)
    chosen = tune.choices(left_out, from_all)
    for pool in [*RECORDED, *APART]:
        for method, error in [(tune.methods(LARGE), apart if apart and pool in APART else errors[1]), (tune.methods(DEFAULTS), errors[0]), *((r, 0.45) for r in RIVALS)]:
            for spp in tune.BUDGETS:
                judged._rows[(pool, *method, spp, 0)] = [
                    {"replicate": i, "relmse": error * w, "mse": error * w, "energy_ratio": 0.99, "relmse_dropped": 0.1} for i, w in enumerate(WOBBLE)]
    judge(judged)
    methods = {p: tune.methods(c) for p, c in chosen.items() if p not in without}
    return page(scores, left_out, from_all, judged, methods, OURS, tune.BUDGETS)


def test_the_page_says_when_another_setting_than_the_defaults_is_chosen():
    text = made_page((0.5, 0.4))
    assert "Today's defaults are not the choice from all five pools, which is: filter: `size_factor=const(1)`" in text
    assert text.index("| mist | 16 | 0.5") > text.index("## The target with today's defaults") > text.index("| mist | 16 | 0.4")
    assert "changes relMSE by -20.0 %" in text and "lower beyond the noise" in text
    assert "relMSE is met in 21 of 21 cells" in text and "With today's defaults: relMSE is met in 0 of 21 cells" in text


def test_the_page_says_when_the_defaults_are_the_choice():
    text = made_page((0.4, 0.5))
    assert "Today's defaults are the choice from all five pools.**" in text and "## The target with today's defaults" not in text
    assert all(f"| {pool} | 8 |" in text for pool in RECORDED)


def test_pools_that_were_not_judged_yet_are_named():
    text = made_page((0.5, 0.4), ["table", "fireflies"])
    assert "**Not judged yet: table.**" in text and "**Not judged yet: fireflies.**" in text and "| table | 8 |" not in text
    assert made_page((0.5, 0.4), APART).count("**Not judged yet.**") == 1


def test_each_option_alone_is_shown_pool_by_pool():
    made = {c: {p: [cell(e if p != "mist" else 0.5)] for p in CHOOSING} for c, e in ((DEFAULTS, 0.5), (LARGE, 0.4), (BOTH, 0.1))}
    text = "\n".join(single_section(Scores({c: {p: [(e, n, made[DEFAULTS][p][0][0]) for e, n, _ in v] for p, v in by.items()}
                                            for c, by in made.items()}, CHOOSING)))
    assert "| filter: `size_factor=const(1)` | -0.179 | -0.223 | -0.223 | -0.223 | +0.000 | -0.223 |" in text
    assert "init_spp" not in text


def test_the_choice_is_shown_change_by_change_on_pools_kept_apart():
    alone = Results([])
    for pool, ratio in (("fireflies", 0.5), ("scene_s", 0.5), ("scene_s_128", 2.0), ("scene_s_fireflies", 0.5), ("scene_s_fireflies_128", 2.0)):
        for method, error in ((OURS, 1.0), (tune.methods(LARGE), ratio)):
            alone._rows[(pool, *method, 8, 0)] = [{"replicate": r, "relmse": error * w} for r, w in enumerate(WOBBLE)]
    text = "\n".join(alone_section(judge(alone), [(LARGE, tune.methods(LARGE))], OURS))
    assert "beyond the noise on some of these: filter: `size_factor=const(1)`. On none: none." in text
    row = next(line for line in text.splitlines() if line.startswith("| filter: `size_factor=const(1)`"))
    assert [cell.strip()[:4] for cell in row.split("|")[2:7]] == ["0.50", "0.50", "2.00", "0.50", "2.00"]


def test_a_choice_that_harms_where_it_had_no_say_is_said_to_do_so():
    assert "harms on the pools kept apart" in made_page((0.5, 0.4), apart=0.6)
    assert "harms on the pools kept apart" not in made_page((0.5, 0.4))

"""The choice of options: verdicts of the program are counted, and nothing else."""
from pathlib import Path

from plan_methods import methods_of
from tools.study import plans, tune

BASE = "multiscale + directional"
TURNED = f"{BASE}{{levels=3}}"
BOTH = f"{BASE}{{levels=3,size_factor=inverse}}"


def claim(better, **verdicts):
    return {"better": better, "than": BASE, "metric": "relmse", "samples": "own", "verdict": "mixed", "counts": {},
            "places": [{"dump": name, "spp": 4.0, "verdict": v, "ratio": [0.9, 0.8, 1.0]} for name, v in verdicts.items()]}


def candidates(*claims, energy=()):
    results = [{"dump": d, "spp": 4.0, "sampler": m.split(" + ")[0], "filter": m.split(" + ")[1], "quantities": {"energy_ratio": e}}
               for d, m, e in energy]
    return tune.Candidates({"claims": list(claims), "results": results})


def test_the_claim_that_holds_at_most_places_is_chosen_without_the_one_left_out():
    found = candidates(claim(TURNED, a="holds", b="undecided", c="reversed"), claim(BOTH, a="undecided", b="holds", c="holds"))
    assert found.choose(["a", "b", "c"]) == (found.claims[1], 2)
    assert found.choose(["a", "b"])[0] is found.claims[0]  # as many, fewer options
    assert tune.choices(found, ["a", "b", "c"])[2][:3] == ["c", f"`{TURNED}`", 1]
    assert "reversed 0.900 [0.800, 1.00] at 4" in tune.choices_table(found, ["a", "b", "c"])


def test_defaults_stay_where_nothing_gains():
    found = candidates(claim(TURNED, a="holds", b="reversed"))
    assert found.choose(["a", "b"]) == (None, 0) and tune.choices(found, ["a", "b"])[-1][1] == "the defaults"


def test_light_that_the_candidate_alone_loses_counts_against_it():
    lost, kept = [0.9, 0.89, 0.91], [0.99, 0.98, 1.0]
    one = claim(TURNED, a="holds")
    assert candidates(one, energy=[("a", TURNED, lost), ("a", BASE, kept)]).count(one, ["a"]) == 0
    assert candidates(one, energy=[("a", TURNED, lost), ("a", BASE, lost)]).count(one, ["a"]) == 1
    assert candidates(one, energy=[("a", TURNED, [0.96, 0.9, 1.0]), ("a", BASE, kept)]).count(one, ["a"]) == 1  # within its interval


def test_the_plans_ask_every_candidate_once_against_the_defaults():
    for name in ("tuning", "tuning_full"):
        plan = plans.read(plans.PLANS / f"{name}.toml")
        labels = [f"{s[0]} + {f[0]}" for s in methods_of(plan, "sampler") for f in methods_of(plan, "filter")]
        asked = [c["better"] for c in plan["claim"]]
        assert len({c["than"] for c in plan["claim"]}) == 1
        assert sorted([*asked, plan["claim"][0]["than"]]) == sorted(labels)


def test_the_choice_is_judged_on_recordings_that_never_choose():
    plan = tune.apart_plan(claim("multiscale{explore_fraction=0.4} + directional{analysis_channel=per_channel,levels=2}"))
    choosing = {Path(p).stem for p in plans.read(plans.PLANS / "tuning.toml")["recordings"]}
    assert not {Path(p).stem for p in plan["recordings"]} & choosing and plan["claim"][0]["than"] == BASE
    labels = [f"{s[0]} + {f[0]}" for s in methods_of(plan, "sampler") for f in methods_of(plan, "filter")]
    assert {BASE, plan["claim"][0]["better"]} <= set(labels)

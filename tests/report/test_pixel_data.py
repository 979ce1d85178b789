"""Weights of filters in the report: of the program's own methods only, in what is drawn of them."""

import json
import stat
from types import SimpleNamespace

import pytest

from tools.report import pixel_data
from tools.report.pixel_data import footprints_of
from tools.report.vocabulary import Vocabulary

OWN = Vocabulary({"samplers": ["uniform", "multiscale"], "footprints": ["box", "directional"]})
TOLD = {"taps": [[12, 10, 0.7, 1.0, 1.0, 1.0], [13, 9, 0.2999, 1.0, 1.0, 1.0], [14, 9, 0.0001, 1.0, 1.0, 1.0]],
        "shapes": [{"size": 4, "direction": 30.0, "widths": [[30.0, 1.6]]}]}


@pytest.fixture
def program(tmp_path):
    path = tmp_path / "program"
    (tmp_path / "answer").write_text(json.dumps([{"footprint": TOLD}]))
    path.write_text(f"#!/bin/sh\necho \"$@\" >> '{tmp_path}/asked'\ncat '{tmp_path}/answer'\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def told(program, sampler, filter_):
    combination = SimpleNamespace(sampler=sampler, filter=filter_, spp=8.0)
    return footprints_of(str(program), "a.spool", ["--order", "recorded"], [(12, 10)], combination, OWN)


def test_weights_are_around_the_pixel_and_the_smallest_are_left_out(program, tmp_path):
    footprint, = told(program, "multiscale{alpha=0.9}", "directional:paper")
    assert footprint == {"taps": [[0, 0, 0.7], [1, -1, 0.2999]], "shapes": TOLD["shapes"]}
    asked = (tmp_path / "asked").read_text()
    assert "--sampler=multiscale{alpha=0.9} --filter=directional:paper --spp=8" in asked and "--at 12,10" in asked


@pytest.mark.parametrize("sampler, filter_", [("exec:touch x", "box"), ("uniform", "exec:touch x"), ("uniform", "nl_means"),
                                              ("--sampler=exec:x", "box"), ("", "box"), ("counts:n.exr", "box"),
                                              ("uniform=exec:touch x", "box"), ("uniform\n", "box")])
def test_a_name_that_is_no_method_of_the_program_is_never_asked_for(program, tmp_path, sampler, filter_):
    assert told(program, sampler, filter_) == []
    assert not (tmp_path / "asked").exists()


def test_a_filter_that_says_nothing_is_left_out(program, tmp_path):
    (tmp_path / "answer").write_text(json.dumps([{"footprint": None}]))
    assert told(program, "uniform", "box") == []


@pytest.mark.parametrize("recordings, asked_for", [(("a",), ["half", "more", "unknown"]), (("a", "b"), ["more", "other", "unknown"])])
def test_footprints_cost_a_share_of_what_the_results_did_each_recording_alike(monkeypatch, recordings, asked_for):
    asked, used = [], [0.0]

    def footprints(*words):
        combination = words[4]
        asked.append((combination.dump, combination.filter))
        used[0] += 0.2 if combination.filter == "more" else float(combination.rows[0]["cpu_sampling"] or 0)
        return [{}]
    monkeypatch.setattr(pixel_data, "ask", lambda *_: [{}])
    monkeypatch.setattr(pixel_data, "choose_pixels", lambda _: [(0, 0)])
    monkeypatch.setattr(pixel_data, "recording_paths", lambda _: dict.fromkeys(recordings, __file__))
    monkeypatch.setattr(pixel_data, "footprints_of", footprints)
    monkeypatch.setattr(pixel_data.resource, "getrusage", lambda _: SimpleNamespace(ru_utime=used[0]))
    costs = {"dear": 9.0, "half": 0.45, "more": 0.1, "other": 0.16, "unknown": ""}
    combinations = [SimpleNamespace(dump=dump, sampler="uniform", filter=name, spp=8.0 if name == "unknown" else 16.0,
                                    rows=[{"reference": "independent", "cpu_sampling": cost, "cpu_filtering": ""}])
                    for dump in recordings for name, cost in costs.items()]
    found = [SimpleNamespace(dump=c.dump, combination=i, paths={}) for i, c in enumerate(combinations)]
    answers = pixel_data.pixel_answers("program", found, combinations, {"plan": {"seed": 1, "order": "disjoint"}}, OWN)
    assert asked == [(dump, name) for dump in recordings for name in asked_for]
    assert all(len(answers[dump]["footprints"]) == len(asked_for) for dump in recordings)

"""The package and the program: the same bits for every sampler and every filter, from a file and from arrays."""
import time

import numpy as np
import pytest

import spool
from spool import exr

OF_THE_LIBRARY = {"sampler": [name for name, one in spool.samplers().items() if not one["argument"]],
                  "filter": [name for name, one in spool.filters().items() if not one["argument"] and name != "oidn"]}
IN_LOOP = {"filtered_halves": "box", "cross_halves": "box"}  # the default filter of cross_halves takes its time


def good(outcome):
    assert outcome[0] == 0, outcome[1]


def test_every_method_is_asked_for():
    assert len(OF_THE_LIBRARY["sampler"]) >= 10 and len(OF_THE_LIBRARY["filter"]) >= 12


@pytest.mark.parametrize("name", OF_THE_LIBRARY["sampler"])
def test_samplers(name, path, dump, layers, program):
    in_loop = ("--filter", IN_LOOP[name]) if name in IN_LOOP else ()
    text = f"{name}{{filter=beside}}" if name in IN_LOOP else name
    good(program("replay", path, "--sampler", text, "--spp", "5.5", "--order", "shuffled", "--seed", "7", "-o", "n.exr",
                 "--views", "all", *in_loop))
    wrote = exr.read(path.parent / "n.exr")
    for samples in (dump, path, spool.recording(**layers)):
        chosen = spool.replay(samples, text, 5.5, order="shuffled", seed=7, filter=IN_LOOP.get(name), views=["all"])
        assert np.array_equal(chosen.counts, wrote["n"])
        assert chosen.log["spent"] == wrote["n"].sum()
        views = {f"view.{key}": image.astype("f4") for key, image in chosen.views.items()}
        for key in wrote:
            if key.startswith("view."):
                assert np.array_equal(views.pop(key), wrote[key], equal_nan=True), key
        assert not [key for key, image in views.items() if image.shape == chosen.counts.shape]


@pytest.mark.parametrize("name", OF_THE_LIBRARY["filter"])
def test_filters(name, path, dump, layers, program):
    good(program("replay", path, "--sampler", "multiscale", "--spp", "6", "-o", "n.exr"))
    good(program("reconstruct", path, "--selection", "n.exr", "--filter", name, "--layers", "-o", "image.exr"))
    wrote = exr.read(path.parent / "image.exr")
    for samples in (dump, spool.recording(**layers)):
        chosen = spool.replay(samples, "multiscale", 6)
        made = spool.reconstruct(samples, chosen, name, whole=True)
        assert np.array_equal(made.image.astype("f4"), np.stack([wrote[c] for c in "RGB"], axis=-1))
        assert np.array_equal(made.image, spool.reconstruct(samples, chosen, name, threads=1))
        assert ("variance.R" in wrote) == (made.variance is not None)
        if made.variance is not None:
            assert np.array_equal(made.variance[..., 1].astype("f4"), wrote["variance.G"])


def test_options_views_and_pieces(path, dump, program):
    good(program("replay", path, "--sampler", "multiscale", "--spp", "8", "--set", "sampler.alpha=0.3", "--pieces", "2",
                 "-o", "n.exr", "--views", "P"))
    chosen = spool.replay(dump, "multiscale", spp=8, alpha=0.3, pieces=2)
    wrote = exr.read(path.parent / "n.exr")
    assert np.array_equal(chosen.counts, wrote["n"])
    assert np.array_equal(chosen.views["P.2"].astype("f4"), wrote["view.P.2"])
    assert chosen.image.shape == (dump.height, dump.width, 3)


def test_split_decisions(path, dump, program):
    good(program("replay", path, "--sampler", "multiscale", "--spp", "6", "--decision-split", "-o", "n.exr"))
    good(program("reconstruct", path, "--selection", "n.exr", "--filter", "directional", "-o", "image.exr"))
    chosen = spool.replay(dump, "multiscale", 6, decision_split=True)
    wrote = exr.read(path.parent / "image.exr")
    image = spool.reconstruct(dump, chosen, "directional")
    assert np.array_equal(image.astype("f4"), np.stack([wrote[c] for c in "RGB"], axis=-1))


def test_counts_of_anybody_and_first_samples(dump, layers):
    counts = np.full((dump.height, dump.width), 3)
    image = spool.reconstruct(dump, counts, "box")
    assert np.array_equal(image, spool.reconstruct(dump, None, "box", spp=3))
    assert np.allclose(image, layers["radiance"][:, :, :3].mean(axis=2), rtol=1e-6)


def test_metrics(path, dump, program, tmp_path):
    image = spool.reconstruct(dump, None, "gaussian", spp=4).astype("f4")
    reference = dump.pixel("reference")
    for name, pixels in (("a", image), ("b", reference)):
        exr.write(tmp_path / f"{name}.exr", {c: pixels[..., i] for i, c in enumerate("RGB")})
    import json
    import os
    import subprocess
    said = json.loads(subprocess.run([os.environ["SPOOL_PROGRAM"], "metrics", tmp_path / "a.exr", tmp_path / "b.exr", "--json"],
                                     check=True, capture_output=True).stdout)["metrics"]
    judged = spool.metrics(image, reference, standard_errors=True)
    assert set(judged) == set(said) and len(said) > 10
    for name, (value, error) in judged.items():
        assert said[name]["value"] == (None if np.isnan(value) else value), name
        assert said[name]["standard_error"] == (None if np.isnan(error) else error), name


def test_synth(tmp_path, program):
    good(program("synth", "slanted_edge", "--size", "16x12", "--samples", "8", "--seed", "3", "--set", "angle=45", "-o", "a.spool"))
    made = spool.synth("slanted_edge", width=16, height=12, spp=8, seed=3, angle=45)
    with spool.open(tmp_path / "a.spool") as other:
        assert np.array_equal(made.read("radiance"), other.read("radiance"))
        assert np.array_equal(made.pixel("reference"), other.pixel("reference"))


def test_evaluate(path, dump, layers, program, tmp_path):
    good(program("evaluate", path, "--samplers", "uniform,multiscale", "--filters", "box,directional", "--spp", "3,6",
                 "--replicates", "2", "--seed", "5", "-o", "results", "-q"))
    program_rows = spool.results(tmp_path / "results").rows
    plan = {"recordings": path, "samplers": ["uniform", "multiscale"], "filters": ["box", "directional"], "spp": [3, 6],
            "replicates": 2, "seed": 5}
    made = spool.evaluate(plan)
    assert same_rows(made.rows, program_rows) and len(made.rows) == 16
    assert made.statistics["results"]
    named = spool.recording(**layers, name="scene")
    assert same_rows(spool.evaluate({**plan, "recordings": named}).rows, program_rows, "verified")
    text = tmp_path / "plan.toml"
    text.write_text('recordings = ["scene.spool"]\nsamplers = ["uniform", "multiscale"]\n'
                    'filters = ["box", "directional"]\nspp = [3, 6]\nreplicates = 2\nseed = 5\n')
    said = []
    of_file = spool.evaluate(text, output=tmp_path / "kept", progress=lambda *far: said.append(far))
    assert same_rows(of_file.rows, program_rows) and said[-1] == (1.0, 16, 16)
    assert (tmp_path / "kept" / "contact_sheet.png").exists() or list((tmp_path / "kept").rglob("*.png"))


def same_rows(rows, others, *but):
    timing = {"threads", "alone", "peak_memory", "timing", "dump", "dump_path", *but}

    def facts(row):
        return {key: value for key, value in row.items()
                if key not in timing and not any(word in key for word in ("seconds", "cpu", "time", "efficiency", "_s"))}
    for row, other in zip(rows, others):
        assert facts(row) == facts(other)
    return len(rows) == len(others)


def test_metrics_that_are_asked_for(layers):
    image, reference = layers["radiance"].mean(axis=2), layers["reference"]
    whole = spool.metrics(image, reference, standard_errors=True, variance=layers["reference_variance"])
    for name in whole:
        one = spool.metrics(image, reference, metrics=name, standard_errors=True, variance=layers["reference_variance"])
        assert list(one) == [name] and np.array_equal(one[name], whole[name], equal_nan=True), name
    some = spool.metrics(image, reference, metrics=["ssim", "relmse", "energy_ratio_d3"])
    assert list(some) == ["relmse", "ssim", "energy_ratio_d3"]  # as in every table
    with pytest.raises(spool.SpoolError, match="unknown metric 'relmze', did you mean 'relmse'"):
        spool.metrics(image, reference, metrics=["relmze"])


def test_one_metric_is_cheap():
    image = np.random.default_rng(1).random((256, 256, 3))

    def seconds(**wanted):
        before = time.process_time()
        spool.metrics(image, 0.5 * image, **wanted)
        return time.process_time() - before
    seconds()
    assert min(seconds(metrics=["relmse"]) for _ in range(3)) < 0.2 * seconds()


@pytest.mark.filterwarnings("error::UserWarning")  # none names a file that the caller never saw
def test_arrays_of_one_plan(layers):
    layers["radiance"][0, 0, 0] = np.nan
    one, two = layers["radiance"], 2 * layers["radiance"]
    results = spool.evaluate({"recordings": [one, spool.recording(two, reference=2 * layers["reference"]), 3 * one],
                              "spp": [4], "replicates": 2, "samplers": ["uniform"], "filters": ["box"]})
    assert sorted({row["dump"] for row in results.rows}) == ["recording", "recording_2", "recording_3"]

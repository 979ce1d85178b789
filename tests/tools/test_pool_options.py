"""Options of the pool: quarter pixels, held-out samples, split decisions, in replay, reconstruct and evaluate."""
import numpy as np
import pytest

from conftest import read_exr, samples, write_dump
from results_comparison import rows_of


@pytest.fixture
def scene(good, tmp_path):
    good("synth", "scene_s", "--size", "20x16", "--samples", 32, "-o", "s.spool")
    return tmp_path / "s.spool"


def test_a_split_decision_averages_each_half_as_the_other_decided(good, dump, tmp_path):
    radiance, _ = samples()
    taken = good("replay", dump, "--sampler", "multiscale", "--spp", 6, "--decision-split", "-o", "n.exr", "--json").json
    even, odd, n = (read_exr(tmp_path / "n.exr", name).astype(int) for name in ("even.n", "odd.n", "n"))
    assert even.sum() + odd.sum() == 6 * n.size == taken["budget"]
    assert (n == 2 * np.maximum(even, odd)).all() and n.sum() == taken["spent"]
    good("reconstruct", dump, "--selection", "n.exr", "--filter", "box", "-o", "i.exr")
    for c, name in enumerate("RGB"):
        halves = [(radiance[:, :, h::2, c] * (np.arange(8) < m[:, :, None])).sum(axis=2) / m
                  for h, m in enumerate((even, odd))]
        assert np.allclose(read_exr(tmp_path / "i.exr", name), np.mean(halves, axis=0), rtol=1e-5)


def test_a_poisoned_half_does_not_change_its_own_counts(good, dump, tmp_path):
    radiance, _ = samples()
    radiance[:, :, 1::2] *= 7
    other = write_dump(tmp_path / "other.spool", radiance)
    for name, path in (("a", dump), ("b", other)):
        good("replay", path, "--sampler", "multiscale", "--spp", 6, "--decision-split", "-o", f"{name}.exr")
    odd = [read_exr(tmp_path / f"{name}.exr", "odd.n") for name in "ab"]
    assert (odd[0] == odd[1]).all()


def test_evaluate_splits_decisions_and_says_so(good, scene, tmp_path):
    common = (scene, "--samplers", "multiscale", "--filters", "box", "--spp", 8, "--replicates", 2, "--no-pictures")
    good("evaluate", *common, "--decision-split", "-o", "split")
    good("evaluate", *common, "-o", "plain")
    split, plain = (rows_of(tmp_path / name) for name in ("split", "plain"))
    assert all(int(row["samples_spent"]) == 8 * 320 for row in plain)
    assert all(int(row["samples_spent"]) > 8 * 320 and row["error"] == "" for row in split)
    assert '"decision_split": true' in (tmp_path / "split/manifest.json").read_text()
    plan = (tmp_path / "split/plan.toml").read_text()
    assert "decision_split = true" in plan
    good("evaluate", tmp_path / "split/plan.toml", "-o", "again")
    assert [row["mse"] for row in rows_of(tmp_path / "again")] == [row["mse"] for row in split]


def test_evaluate_takes_fresh_samples_and_resumes_without_mixing(good, scene, tmp_path):
    common = (scene, "--samplers", "uniform,multiscale", "--filters", "box,clamped", "--spp", "4,20", "--replicates", 2,
              "--no-pictures")
    good("evaluate", *common, "--fresh", "-o", "fresh")
    good("evaluate", *common, "-o", "plain")
    fresh, plain = (rows_of(tmp_path / name) for name in ("fresh", "plain"))
    assert [row["mse"] for row in fresh] == [row["mse"] for row in plain]
    assert all(row["mse_fresh"] == row["relmse_variance"] == "" for row in plain)
    for row in fresh:
        if row["spp"] == "20":  # a half of the recording's 32 samples is shorter
            assert row["mse_fresh"] == "" and row["error"] == ""
        elif row["sampler"] == "uniform":
            parts = float(row["mse_bias2"]) + float(row["mse_variance"])
            assert abs(parts / float(row["mse_fresh"]) - 1) < 1e-9
    assert "fresh = true" in (tmp_path / "fresh/plan.toml").read_text()
    good("evaluate", tmp_path / "fresh/plan.toml", "-o", "again")
    assert [row["mse_fresh"] for row in rows_of(tmp_path / "again")] == [row["mse_fresh"] for row in fresh]


def test_any_filter_takes_clamp_and_energy(good, run, dump, tmp_path):
    good("replay", dump, "--sampler", "uniform", "--spp", 4, "-o", "n.exr")
    make = ("reconstruct", dump, "--selection", "n.exr")
    good(*make, "--filter", "box", "-o", "box.exr")
    good(*make, "--filter", "gaussian", "-o", "gaussian.exr")
    for name, method in (("energy", "gaussian{energy=box}"), ("both", "gaussian{clamp=on,energy=box}")):
        good(*make, "--filter", method, "-o", f"{name}.exr")
        for channel in "RGB":
            image, box = (read_exr(tmp_path / f"{n}.exr", channel).astype(float).sum() for n in (name, "box"))
            assert abs(image / box - 1) < 1e-5
    good(*make, "--filter", "image:gaussian.exr", "--set", "filter.energy=box", "-o", "external.exr")
    assert np.allclose(read_exr(tmp_path / "external.exr", "G"), read_exr(tmp_path / "energy.exr", "G"), rtol=1e-5)
    refused = run(*make, "--filter", "box{energy=all}", "-o", "x.exr")
    assert refused.code == 2 and "option energy: 'all' is not one of off|box" in refused.err
    run(*make, "--filter", "box{clmp=on}", "-o", "x.exr").failed_with(2, "did you mean 'clamp'")
    run(*make, "--filter", "directional{size_coarze=2}", "-o", "x.exr").failed_with(2, "did you mean 'size_coarse'")


def test_quarter_pixels_in_all_three_verbs(good, run, scene, dump, tmp_path):
    good("replay", scene, "--sampler", "multiscale", "--spp", 8, "--pieces", 2, "-o", "n.exr")
    n = read_exr(tmp_path / "n.exr", "n")
    assert n.shape == (32, 40) and n.sum() == 8 * 320
    said = good("reconstruct", scene, "--selection", "n.exr", "--filter", "directional", "--views", "level,f", "-o", "i.exr")
    assert read_exr(tmp_path / "i.exr", "R").shape == (16, 20)
    assert "i_pieces.exr" in said.out and read_exr(tmp_path / "i_pieces.exr", "view.level").shape == (32, 40)
    good("evaluate", scene, "--samplers", "multiscale", "--filters", "directional", "--spp", 8, "--replicates", 2,
         "--pieces", 2, "--no-pictures", "-o", "out")
    assert all(row["error"] == "" for row in rows_of(tmp_path / "out"))
    assert '"pieces_per_side": 2' in (tmp_path / "out/manifest.json").read_text()
    run("replay", dump, "--sampler", "uniform", "--spp", 4, "--pieces", 2, "-o", "m.exr").failed_with(1, "film")


def test_held_out_samples_are_never_taken(good, run, dump, tmp_path):
    good("replay", dump, "--sampler", "uniform", "--spp", 12, "--holdout", 4, "-o", "n.exr", "--force")
    assert (read_exr(tmp_path / "n.exr", "n") == 12).all()
    make = ("reconstruct", dump, "--selection", "n.exr")
    good(*make, "--filter", "box", "--holdout", 4, "-o", "held.exr")
    run(*make, "--filter", "box", "--holdout", 8, "-o", "i.exr").failed_with(2, "--holdout 8: n.exr was made with 4: leave --holdout out")
    run("replay", dump, "--sampler", "uniform", "--spp", 13, "--holdout", 4, "-o", "m.exr").failed_with(1, "--spp 12")


def test_a_given_image_cannot_be_made_of_halves(good, run, dump, tmp_path):
    good("reconstruct", dump, "--filter", "box", "--spp", 2, "-o", "mine.exr")
    good("replay", dump, "--sampler", "multiscale", "--spp", 6, "--decision-split", "-o", "n.exr")
    run("reconstruct", dump, "--selection", "n.exr", "--filter", "image:mine.exr",
        "-o", "i.exr").failed_with(2, "image:mine.exr", "split decisions")

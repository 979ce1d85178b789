"""Samplers and filters that are Python functions take part beside the library's."""
import copy
import gc
import pickle

import numpy as np
import pytest

import spool


@spool.sampler(rounds=3, init_spp=2)
def flat(statistics, amount=2):
    """The same everywhere."""
    return np.full(statistics.n.shape, amount)


@spool.sampler
def by_weight(statistics):
    return np.where(statistics.luminance > 1, 1.0, 0.0)


@spool.filter
def mean_of_samples(statistics, gain=1.0):
    return statistics.mean * gain


@spool.sampler(features=True)
def sees_features(statistics):
    assert set(statistics.features) == {"albedo", "normal", "depth"}
    assert statistics.features["albedo"].shape == (*statistics.n.shape, 3)
    assert statistics.feature_variances["albedo"].shape == (*statistics.n.shape, 3)
    assert np.abs(statistics.features["depth"]).max() == 1  # of its largest mean
    assert (statistics.feature_variances["depth"] >= 0).all() and statistics.moments == {}
    return statistics.features["albedo"][..., 0]


def test_whole_numbers_are_wants(dump):
    assert (spool.replay(dump, flat, 8).counts == 8).all()  # 2 first, 3 rounds of 2
    assert (spool.replay(dump, flat, 8, amount=1).counts == 5).all()
    assert spool.replay(dump, flat, 8, amount=1, rounds=2, init_spp=1).counts.max() == 3


def test_other_numbers_share_the_budget_out(dump):
    chosen = spool.replay(dump, by_weight, 5)
    wanted = spool.replay(dump, "uniform", 2).image @ (0.2126, 0.7152, 0.0722) > 1
    assert chosen.log["spent"] == 5 * dump.width * dump.height
    assert chosen.counts[wanted].mean() > 2 * chosen.counts[~wanted].mean()


def test_what_a_sampler_is_told(dump, layers):
    told = []

    @spool.sampler(rounds=2, init_spp=3)
    def curious(statistics):
        told.append(statistics)
        return np.ones(statistics.n.shape, int)

    spool.replay(dump, curious, 7, seed=11)
    first, second = told
    assert (first.n == 3).all() and (second.n == 4).all() and (first.left == 13).all()
    assert (first.round, first.rounds, first.seed) == (0, 2, 11) and second.round == 1
    assert first.budget_left == 4 * 480 and first.share == 2 * 480
    expected = layers["radiance"][:, :, :4].astype("f8")
    assert np.allclose(second.mean, expected.mean(axis=2), rtol=1e-12)
    assert np.allclose(second.variance, expected.var(axis=2, ddof=1) / 4, rtol=1e-9)


def test_features(dump):
    chosen = spool.replay(dump, sees_features, 6)
    assert chosen.counts[-1, -1] > chosen.counts[0, 0]


@spool.filter(moments=(0.25, 1))
def sees_moments(statistics):
    assert list(statistics.moments) == [0.25, 1.0]
    assert np.allclose(statistics.moments[1.0]["mean"], statistics.mean)
    assert np.allclose(statistics.moments[1.0]["m2"] / 30, statistics.variance, rtol=1e-6)
    fourth = statistics.moments[0.25]
    assert (fourth["m4"] * 6 >= 0.999 * fourth["m2"] ** 2).all() and (fourth["m2"] > 0).any()
    return (1 + 0.25 * fourth["mean"]) ** 4


def test_moments_of_transformed_samples(dump):
    seen = spool.reconstruct(dump, None, sees_moments, spp=6)
    box = spool.reconstruct(dump, None, "box", spp=6)
    assert (seen <= box * 1.0001).all() and seen.mean() > 0.5 * box.mean()  # power means
    assert "moments" in str(pytest.raises(spool.SpoolError, spool.reconstruct, dump, None, sees_moments, spp=6, moments="9").value)


def test_features_have_variances(dump, layers):
    told = []

    @spool.filter(features=True)
    def curious(statistics):
        told.append(statistics)
        return statistics.mean

    spool.reconstruct(dump, None, curious, spp=8)
    normals = layers["normal"][:, :, :8].astype("f8")
    assert np.allclose(told[0].features["normal"], normals.mean(axis=2), rtol=1e-6, atol=1e-7)
    assert np.allclose(told[0].feature_variances["normal"], normals.var(axis=2, ddof=1) / 8, rtol=1e-5)
    # The same in every sample: what is left is the least variance that a mean has (lib/statistics/variance_of_mean.h).
    assert (told[0].feature_variances["albedo"] <= 1.001 * (1e-6 * told[0].features["albedo"] + 1e-9) ** 2).all()


def test_what_holds_arrays_is_equal_to_itself_alone(dump):
    told = []
    keeps = spool.filter(lambda statistics: told.append(statistics) or statistics.mean)
    made = [spool.reconstruct(dump, None, keeps, whole=True) for _ in range(2)]
    for first, second in (made, told):
        assert first == first and first != second and len({first, second, first}) == 2 and second in [first, second]


def test_the_stage_of_every_filter_stands_around_it_too(dump, layers):
    layers["radiance"][7, 7, 2] = 500.0
    bright = spool.recording(layers["radiance"])
    box = spool.reconstruct(bright, None, "box", spp=6, clamp=True)
    assert np.array_equal(spool.reconstruct(bright, None, mean_of_samples, spp=6, clamp=True), box)
    assert box[7, 7, 0] < 0.5 * spool.reconstruct(bright, None, "box", spp=6)[7, 7, 0]
    dim = spool.reconstruct(dump, None, mean_of_samples, spp=6, gain=0.5, energy="box")
    whole = spool.reconstruct(dump, None, "box", spp=6)
    assert dim.sum() == pytest.approx(whole.sum(), rel=1e-3)  # half of it without
    with pytest.raises(spool.SpoolError, match="energy already"):
        spool.filter(lambda statistics, energy=1.0: statistics.mean, label="takes the name")
    with pytest.raises(spool.SpoolError, match="option gian: unknown"):
        spool.reconstruct(dump, None, mean_of_samples, spp=6, gian=2, clamp=True)


def test_a_filter(dump):
    box = spool.reconstruct(dump, None, "box", spp=4)
    assert np.array_equal(spool.reconstruct(dump, None, mean_of_samples, spp=4), box)
    assert np.array_equal(spool.reconstruct(dump, None, mean_of_samples, spp=4, gain=2), 2 * box)


def test_evaluate_judges_them_like_any_other(dump, path):
    results = spool.evaluate({
        "recordings": [dump], "spp": [5], "replicates": 3,
        "samplers": ["uniform", {"name": flat, "rounds": 2, "amount": [1, 2], "label": "ours"}],
        "filters": ["box", mean_of_samples]})
    of = {(row["sampler"], row["filter"], row["replicate"]): row for row in results.rows}
    assert {key[0] for key in of} == {"uniform", "ours{amount=1}", "ours{amount=2}"}
    assert {key[1] for key in of} == {"box", "mean_of_samples"}
    assert len(of) == 18 and not any(row["error"] for row in results.rows)
    for (sampler, filter, replicate), row in of.items():
        assert row["relmse"] == of[sampler, "box", replicate]["relmse"]
    means = {(mean["sampler"], mean["filter"]): mean for mean in results.means}
    assert len(means) == 6
    value, low, high = means["ours{amount=2}", "box"]["quantities"]["relmse"]
    assert low < value < high


@pytest.mark.parametrize("folder", [None, "kept"])
def test_one_that_fails_leaves_the_results_of_the_others(dump, tmp_path, folder):
    bad = spool.filter(lambda statistics: 1 / 0, label="bad")
    plan = {"recordings": [dump], "spp": [4], "replicates": 2, "samplers": ["uniform"], "filters": ["box", bad]}
    output = folder and tmp_path / folder
    for _ in range(2):  # those that failed are tried again
        with pytest.raises(spool.SpoolError, match="2 of 4 results failed") as caught:
            spool.evaluate(plan, output=output)
        gc.collect()
        found = caught.value.results
        assert sorted((row["filter"], "ZeroDivisionError" in (row["error"] or "")) for row in found.rows) == [("bad", True)] * 2 + [("box", False)] * 2
        assert [mean["filter"] for mean in found.means if "quantities" in mean] == ["box"]
    if folder:
        with pytest.raises(spool.SpoolError, match="results that this plan does not have") as caught:
            spool.evaluate({**plan, "filters": ["box"]}, output=output)
        assert not hasattr(caught.value, "results")  # those of another plan


def test_another_function_of_the_same_name_is_another_method(dump, tmp_path):
    def evaluate(function):
        return spool.evaluate({"recordings": [dump], "spp": [4], "replicates": 1, "samplers": [function],
                               "filters": ["box"]}, output=tmp_path / "kept").rows[0]["mse"]

    @spool.sampler
    def mine(statistics):
        return np.ones(statistics.n.shape)
    first = mine
    assert evaluate(first) == evaluate(first)  # what is there is not done again

    @spool.sampler
    def mine(statistics):
        return np.zeros(statistics.n.shape)
    assert mine.key != first.key
    with pytest.raises(spool.SpoolError, match="results that this plan does not have"):
        evaluate(mine)


def test_functions_of_one_text_differ_by_what_they_take_from_around_them(dump):
    def scaled_by(factor):
        @spool.filter
        def scaled(statistics):
            return factor * statistics.mean
        return scaled

    # Numbers, arrays, what has no lasting description, functions and other methods: of one text each.
    factors = [1.0, 0.25, np.full(3, 2.0), np.full(3, 4.0)]
    keys = [scaled_by(factor).key for factor in factors]
    assert len(set(keys)) == len(factors) and keys == [scaled_by(factor).key for factor in factors]
    assert scaled_by(lambda: 1).key != scaled_by(lambda: 2).key
    assert scaled_by(scaled_by(1.0)).key != scaled_by(scaled_by(2.0)).key
    assert scaled_by(n for n in ()).key != scaled_by(n for n in ()).key

    results = spool.evaluate({"recordings": [dump], "spp": [4], "replicates": 1, "samplers": ["uniform"],
                              "filters": ["box", {"name": scaled_by(1.0), "label": "same"},
                                          {"name": scaled_by(0.25), "label": "less"}]})
    error = {row["filter"]: row["mse"] for row in results.rows}
    assert error["same"] == error["box"] != error["less"]


def test_one_function_with_other_settings_is_another_method(dump):
    def flat_once(statistics):
        calls.append(statistics.round)
        return np.ones(statistics.n.shape)
    calls = []
    once, thrice = spool.sampler(flat_once, rounds=1), spool.sampler(flat_once, rounds=3)
    spool.replay(dump, once, 6)
    assert once.key != thrice.key and len(calls) == 1


def test_the_cause_is_that_of_the_named_function(dump):
    @spool.filter
    def first(statistics):
        raise KeyError("first")

    @spool.filter
    def second(statistics):
        raise OSError("second")

    for method, kind in ((first, KeyError), (second, OSError)) * 2:
        with pytest.raises(spool.SpoolError) as raised:
            spool.evaluate({"recordings": [dump], "spp": [4], "replicates": 1, "samplers": ["uniform"],
                            "filters": [method, second if method is first else first]})
        name = "first" if "python:first" in str(raised.value) else "second"
        assert isinstance(raised.value.__cause__, {"first": KeyError, "second": OSError}[name])


def test_names_of_options_that_every_method_has_are_refused():
    for kind, name in ((spool.sampler, "rounds"), (spool.sampler, "init_spp"), (spool.filter, "clamp"), (spool.filter, "moments")):
        scope = {}
        exec(f"def own(statistics, {name}=5): return statistics.n", scope)
        with pytest.raises(spool.SpoolError, match=f"has an option {name} already"):
            kind(scope["own"])


def test_what_a_selection_was_drawn_by_is_not_changed_behind_it(dump):
    selection = spool.replay(dump, "uniform", 4, seed=3)
    spool.reconstruct(dump, selection, "box", seed=3)
    for wrong in ({"spp": 5}, {"seed": 4}, {"order": "shuffled"}, {"pieces": 2}, {"holdout": 4}):
        with pytest.raises(spool.SpoolError, match="leave it out"):
            spool.reconstruct(dump, selection, "box", **wrong)


def test_the_pool_rules_of_a_selection_hold_for_its_image(dump):
    limited, free = (spool.replay(dump, "uniform", 4, pool=pool) for pool in ({"firefly_limit": 0.5}, None))
    assert limited.image.max() <= 0.5 < free.image.max()
    assert np.array_equal(spool.reconstruct(dump, limited, "box"), limited.image)
    for chosen, pool, image in ((limited, {}, free), (free, {"firefly_limit": 0.5}, limited)):
        assert np.array_equal(spool.reconstruct(dump, chosen, "box", pool=pool), image.image)


def test_a_copy_of_results_outlives_them(dump):
    made = spool.evaluate({"recordings": [dump], "spp": [4], "replicates": 1, "samplers": ["uniform"], "filters": ["box"]})
    rows = len(made.rows)
    for copied in (copy.copy(made), copy.deepcopy(made), pickle.loads(pickle.dumps(made))):
        assert len(copied.rows) == rows and copied.means
    kept = copy.copy(made)
    del made
    gc.collect()
    assert len(kept.rows) == rows


amount_of_module = 1.0


def test_a_function_is_another_once_its_module_holds_other_values(dump):
    @spool.filter
    def scaled(statistics):
        return amount_of_module * statistics.mean

    def filtered(amount):
        global amount_of_module
        amount_of_module = amount
        return scaled.key, spool.reconstruct(dump, None, scaled, spp=4)
    (first, whole), (second, half) = filtered(1.0), filtered(0.5)
    assert first != second and first == filtered(1.0)[0]
    assert np.allclose(whole, 2 * half)


def test_in_the_loop_of_a_sampler(dump):
    chosen = spool.replay(dump, "filtered_halves", 6, filter=mean_of_samples)
    assert np.array_equal(chosen.counts, spool.replay(dump, "filtered_halves", 6, filter="box").counts)


def test_the_program_reads_such_results(dump, program, tmp_path):
    spool.evaluate({"recordings": [dump], "spp": [5], "replicates": 2, "samplers": ["uniform", flat], "filters": ["box"]},
                   output=tmp_path / "kept")
    assert program("evaluate", "--statistics-only", "kept", "-q")[0] == 0
    code, line = program("replay", dump.path, "--sampler", f"python:{flat.key}", "--spp", "4", "-o", "n.exr")
    assert code == 2 and "is a function of a Python program" in line

"""docs/scene_needs.md: a recording without some of its layers, and the rows of its tables."""
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("name", ["chess", "caustic_mitsuba"])
def test_a_recording_without_layers_holds_the_same_samples(tmp_path, name):
    import numpy as np
    from tools.study import scene_needs
    import spool
    for kind, layers in scene_needs.SETS.items():
        with spool.open(ROOT / f"dumps/tiny/{name}.spool") as whole:
            if not set(layers) <= set(whole.layers):
                continue
            scene_needs.without(whole.path, layers, tmp_path / f"{kind}.spool")
            with spool.open(tmp_path / f"{kind}.spool") as part:
                assert set(part.layers) == {*layers, "reference", "reference_variance"} & set(whole.layers)
                assert np.array_equal(part.read("radiance"), whole.read("radiance"))
                assert np.array_equal(part.pixel("reference"), whole.pixel("reference"))
                assert {n: part.layers[n].dtype for n in layers} == {n: whole.layers[n].dtype for n in layers}


def test_what_a_layer_costs_and_buys_is_a_row_each():
    from tools.study import scene_needs
    sets = {kind: {"layers": list(layers), "bytes": 12, "file": 1e6 * (1 + i), "microseconds": None if i else 2.0}
            for i, (kind, layers) in enumerate(scene_needs.SETS.items())}
    one = {"recording": "torus", "renderer": "Mitsuba", "sets": sets,
           "relmse": {kind: {"box": [0.5, 0.4, 0.6], "twin_guides": [0.1 / (1 + i), 0.05, 0.2]} for i, kind in enumerate(sets)}}
    cost = scene_needs.cost_rows([one])
    assert ["torus", "Mitsuba", "radiance", 12, "1", "1.00", "1.00"] in cost and ["torus", "Mitsuba", "radiance lens", 12, "3", "3.00", "–"] in cost
    gain = scene_needs.gain_rows([one])
    assert ["features", "twin_guides", "torus", "0.100 [0.0500, 0.200]", "0.0250 [0.0500, 0.200]", "twin_guides 0.1"] in gain
    assert ["features", "cross_bilateral", "torus", "–", "–", "twin_guides 0.1"] in gain


def test_what_leaving_a_need_out_does_is_a_row():
    from tools.study import scene_needs
    row = {"scene": "mist", "need": "medium", "microseconds": 3.0, "microseconds_without": 2.0, "noise": [0.2, 0.1, 0.3],
           "noise_without": [0.1, 0.05, 0.15], "left_out": 0.7, "again": 0.001}
    table = scene_needs.need_table({"rows": [row]})
    assert "| mist | a way through a medium | 1.50 | 0.100 [0.0500, 0.150] | 0.200 [0.100, 0.300] | 0.699 | 0.00100 |" in table


def test_the_page_is_what_is_kept():
    from tools.study import scene_needs
    for name, text in scene_needs.pages().items():
        assert text == (ROOT / "docs" / name).read_text(encoding="utf-8"), "tools/study/scene_needs.py"

"""docs/scene_needs.md: a recording without some of its layers, and the rows of its tables."""
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/experiments"))


@pytest.mark.parametrize("name", ["chess", "caustic_mitsuba"])
def test_a_recording_without_layers_holds_the_same_samples(tmp_path, name):
    import numpy as np
    import scene_needs_full
    import spool
    for kind, layers in scene_needs_full.SETS.items():
        with spool.open(ROOT / f"dumps/tiny/{name}.spool") as whole:
            if not set(layers) <= set(whole.layers):
                continue
            scene_needs_full.without(whole.path, layers, tmp_path / f"{kind}.spool")
            with spool.open(tmp_path / f"{kind}.spool") as part:
                assert set(part.layers) == {*layers, "reference", "reference_variance"} & set(whole.layers)
                assert np.array_equal(part.read("radiance"), whole.read("radiance"))
                assert np.array_equal(part.pixel("reference"), whole.pixel("reference"))
                assert {n: part.layers[n].dtype for n in layers} == {n: whole.layers[n].dtype for n in layers}


def test_what_a_layer_costs_and_buys_is_a_row_each():
    import scene_needs_full
    sets = {kind: {"layers": list(layers), "bytes": 12, "file": 1e6 * (1 + i), "microseconds": None if i else 2.0}
            for i, (kind, layers) in enumerate(scene_needs_full.SETS.items())}
    one = {"recording": "torus", "renderer": "Mitsuba", "sets": sets,
           "relmse": {kind: {"box": [0.5, 0.4, 0.6], "twin_guides": [0.1 / (1 + i), 0.05, 0.2]} for i, kind in enumerate(sets)}}
    assert scene_needs_full.cost_rows([one])[2][-3:] == ["3", "3.00", "–"] and scene_needs_full.cost_rows([one])[0][-1] == "1.00"
    row = next(r for r in scene_needs_full.gain_rows([one]) if r[:2] == ["features", "twin_guides"])
    assert row[3].startswith("0.100") and row[4].startswith("0.0250") and row[5] == "twin_guides 0.1"
    assert next(r for r in scene_needs_full.gain_rows([one]) if r[1] == "cross_bilateral")[3:5] == ["–", "–"]

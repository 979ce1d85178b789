"""docs/scene_needs.md: a recording without some of its layers, and the rows of its tables."""
import json
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


def test_a_part_of_the_page_is_replaced_and_the_rest_kept():
    from whole_file import with_part
    page = "# Page\n\nWords.\n\n## One\n\nold\n\n## Two\n\nkept\n"
    assert with_part(page, "## One", "## One\n\nnew\n") == page.replace("old", "new")
    assert with_part(page, "## Two", "## Two\n\nnew\n") == page.replace("kept", "new")
    with pytest.raises(ValueError, match="Three"):
        with_part(page, "## Three", "")


def test_what_leaving_a_need_out_does_is_a_row(tmp_path, monkeypatch):
    import needs_left_out
    monkeypatch.setattr(needs_left_out, "STORE", tmp_path / "left_out.json")
    row = {"scene": "mist", "need": "medium", "microseconds": 3.0, "microseconds_without": 2.0, "noise": [0.2, 0.1, 0.3],
           "noise_without": [0.1, 0.05, 0.15], "left_out": 0.7, "again": 0.001}
    needs_left_out.STORE.write_text(json.dumps({"size": 128, "samples": 64, "reference": 1024, "spp": 8, "rows": [row]}))
    assert "| mist | a way through a medium (mist) | 1.50 | 0.100 [0.0500, 0.150] | 0.200 [0.100, 0.300] | 0.699 | 0.00100 |" in needs_left_out.part()

"""Colours of figures and of the page: separated in grey print and by colour-blind readers.

Colour vision after [Vienot99] and, without S cones, [Machado09]; lightness and distances in CIELAB under D65.
"""
import re
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from tools.report import draw_curves, figure_comparison

REPORT = Path(__file__).resolve().parents[2] / "tools" / "report"

XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]])
LMS = np.array([[17.8824, 43.5161, 4.11935], [3.45565, 27.1554, 3.86714], [0.0299566, 0.184309, 1.46709]])
BLINDNESS = {  # of linear RGB: what is seen of L or M follows from the other two
    "protanopia": [[0, 2.02344, -2.52581], [0, 1, 0], [0, 0, 1]],
    "deuteranopia": [[1, 0, 0], [0.494207, 0, 1.24827], [0, 0, 1]],
}


TRITANOPIA = np.array([[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]])


def linear(colour):
    s = np.array([int(colour[i:i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4)


def seen_by(rgb, blindness):
    return np.clip(np.linalg.solve(LMS, np.array(BLINDNESS[blindness]) @ LMS @ rgb), 0, 1)


def lab(rgb):
    t = XYZ @ rgb / XYZ.sum(axis=1)
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def lightness(colour):
    return lab(linear(colour))[0]


def colours_of(file, name):
    """The list of colours behind `name:` in a script of the page."""
    text = (REPORT / file).read_text(encoding="utf-8")
    return re.findall(r"#[0-9a-f]{6}", re.search(rf"\b{name}: \[(.*?)\]", text, re.DOTALL)[1])


def test_lines_of_a_figure_differ_without_any_colour():
    assert len(draw_curves.COLOURS) == len(draw_curves.MARKERS) == len(draw_curves.DASHES) == 8
    assert len(set(draw_curves.MARKERS)) == len(set(map(str, draw_curves.DASHES))) == 8
    assert max(map(lightness, draw_curves.COLOURS)) < 75  # none is lost on paper, of lightness 100


def test_frames_of_insets_differ_without_any_colour():
    assert len({str(dash) for _, dash in figure_comparison.FRAMES}) == len(figure_comparison.FRAMES)
    (first, _), (second, _) = figure_comparison.FRAMES[:2]  # those that a figure has unasked
    assert abs(lightness(first) - lightness(second)) > 20


@pytest.mark.parametrize("ramp", ["inferno", "viridis", "magma"])
def test_maps_become_lighter_all_the_way(ramp):
    steps = np.diff([lightness(colour) for colour in colours_of("colour_scales.js", ramp)])
    assert (steps > 4).all(), steps


def test_the_signed_map_becomes_darker_to_both_ends():
    steps = np.diff([lightness(colour) for colour in colours_of("colour_scales.js", "signed")])
    assert (steps[:3] > 4).all() and (steps[3:] < -4).all(), steps


@pytest.mark.parametrize("blindness", BLINDNESS)
@pytest.mark.parametrize("name, colours", [("figure", draw_curves.COLOURS), ("light", colours_of("report_data.js", "light")),
                                           ("dark", colours_of("report_data.js", "dark"))])
def test_colours_of_methods_are_told_apart_by_colour_blind_readers(name, colours, blindness):
    seen = {c: lab(seen_by(linear(c), blindness)) for c in colours}
    near = {(a, b): round(float(np.linalg.norm(seen[a] - seen[b])), 1) for a, b in combinations(colours, 2)}
    assert min(near.values()) > 10, (name, sorted(near.items(), key=lambda item: item[1])[:4])


@pytest.mark.parametrize("name, ground", [("light", "#ffffff"), ("dark", "#14181d")])
def test_colours_of_samplers_stand_out_from_the_page_in_tritanopia_and_in_grey(name, ground):
    colours = colours_of("report_data.js", name)
    seen = [lab(np.clip(TRITANOPIA @ linear(c), 0, 1)) for c in colours]
    assert min(np.linalg.norm(a - b) for a, b in combinations(seen, 2)) > 13
    luminance = [XYZ[1] @ linear(c) + 0.05 for c in (*colours, ground)]
    assert min(max(x, luminance[-1]) / min(x, luminance[-1]) for x in luminance[:-1]) > 3
    # Those of one filling, of four; the first eight.
    assert min(abs(lightness(a) - lightness(b)) for a, b in zip(colours[:4], colours[4:])) > 13

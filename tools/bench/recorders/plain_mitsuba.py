"""Mitsuba's own render of a scene: `mi.render`, nothing kept. Started by overhead.py."""
import os
import sys

DUMPS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "dumps")
sys.path[:0] = [os.path.join(DUMPS, "mitsuba"), os.path.join(DUMPS, "recording")]

from variant import choose_variant  # noqa: E402

import mitsuba as mi  # noqa: E402

name, size, samples, _ = sys.argv[-4:]
mi.set_variant(choose_variant()[0])
from scene import load_scene  # noqa: E402

found = load_scene(mi, name, (int(size), int(size)))
mi.render(found.scene, spp=int(samples)).numpy()

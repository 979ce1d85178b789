"""Mitsuba's own render of a scene: `mi.render`, nothing kept; with features by its `aov` integrator. Started by overhead.py."""
import os
import sys

DUMPS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "dumps")
sys.path[:0] = [os.path.join(DUMPS, "mitsuba"), os.path.join(DUMPS, "recording")]

from variant import choose_variant  # noqa: E402

import mitsuba as mi  # noqa: E402

name, size, samples, channels = sys.argv[-4:]
mi.set_variant(choose_variant()[0])
from scene import Wishes, load_scene  # noqa: E402

found = load_scene(mi, name, Wishes(size=(int(size), int(size))))
integrator = found.scene.integrator()
if channels != "radiance":
    integrator = mi.load_dict({"type": "aov", "aovs": "a:albedo,n:sh_normal,d:depth", "image": integrator})
mi.render(found.scene, integrator=integrator, spp=int(samples)).numpy()

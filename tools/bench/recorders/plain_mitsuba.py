"""Mitsuba's own render of a scene: `mi.render`, nothing kept; with features by its `aov` integrator. Started by overhead.py."""
import os
import sys

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..", "..")))

import mitsuba as mi

from dumps.mitsuba.scene import Wishes, load_scene
from dumps.mitsuba.variant import choose_variant

name, size, samples, channels = sys.argv[-4:]
mi.set_variant(choose_variant()[0])
found = load_scene(mi, name, Wishes(size=(int(size), int(size))))
integrator = found.scene.integrator()
if channels != "radiance":
    integrator = mi.load_dict({"type": "aov", "aovs": "a:albedo,n:sh_normal,d:depth", "image": integrator})
mi.render(found.scene, integrator=integrator, spp=int(samples)).numpy()

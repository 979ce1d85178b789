"""Cycles' own render of a scene with the settings of a recording: one call, nothing kept. Started by overhead.py."""
import os
import sys

DUMPS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "dumps")
sys.path[:0] = [os.path.join(DUMPS, "cycles"), os.path.join(DUMPS, "recording")]

import bpy  # noqa: E402

from passes import plan_channels, switch_passes  # noqa: E402
from scene import load_scene, prepare  # noqa: E402
from settings import apply_settings, select_samples  # noqa: E402

name, size, samples, channels = sys.argv[-4:]
scene, _ = load_scene(name, None)
prepare(scene, None, None, (int(size), int(size)))
apply_settings(scene, bpy.context.view_layer, 0)
switch_passes(bpy.context.view_layer, plan_channels(channels.split(","), "iid"))
select_samples(scene, 1, 0, int(samples))
bpy.ops.render.render(write_still=False)
sys.stdout.flush()
os._exit(0)

"""Cycles' own render of a scene with the settings of a recording: one call, nothing kept. Started by overhead.py."""
import os
import sys

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..", "..")))

import bpy

from dumps.cycles.passes import plan_channels, switch_passes
from dumps.cycles.scene import load_scene, prepare
from dumps.cycles.settings import apply_settings, select_samples

name, size, samples, channels = sys.argv[-4:]
scene, _ = load_scene(name, None)
prepare(scene, None, None, (int(size), int(size)))
apply_settings(scene, bpy.context.view_layer, 0)
switch_passes(bpy.context.view_layer, plan_channels(channels.split(","), "iid"))
select_samples(scene, 1, 0, int(samples))
bpy.ops.render.render(write_still=False)
sys.stdout.flush()
os._exit(0)

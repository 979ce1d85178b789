"""Run by Blender: a scene of dumps/scenes as a .blend file, with one of its needs left out.

    blender -b --factory-startup -P tools/study/blend_without.py -- SCENE lens|time|medium|nothing FILE.blend
"""
import sys
from pathlib import Path

import bpy

DUMPS = Path(__file__).resolve().parents[2] / "dumps"
sys.path[:0] = [str(DUMPS / "cycles"), str(DUMPS / "recording"), str(DUMPS / "scenes")]
from scene import load_scene  # noqa: E402


def leave_out(scene, need):
    if need == "lens":
        scene.camera.data.dof.use_dof = False
    elif need == "time":
        scene.render.use_motion_blur = False
    elif need == "medium":
        for thing in [o for o in scene.objects if any(slot.material and has_volume(slot.material) for slot in o.material_slots)]:
            bpy.data.objects.remove(thing)
    elif need != "nothing":
        sys.exit(f"blend_without: {need} is no need: lens, time, medium or nothing")


def has_volume(material):
    return material.use_nodes and any(link.to_socket.name == "Volume" for link in material.node_tree.links)


def main():
    name, need, file = sys.argv[sys.argv.index("--") + 1:]
    scene, _ = load_scene(name, None)
    leave_out(scene, need)
    bpy.ops.file.pack_all()
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(file).resolve()), compress=True)


main()

"""What a scene does of itself while it is rendered: animation, markers, what the viewport hides, and how far it reaches."""
import json
import os
import subprocess

import pytest
from conftest import Folder, record
from test_record import make_blend
from test_script import SPOOL, run

# A cube 10 in front of the camera, which looks along y; the picture is 16 x 12.
START = """
import math
s = bpy.context.scene
s.render.engine = 'CYCLES'
s.render.resolution_x, s.render.resolution_y = 16, 12
c = s.camera
c.location, c.rotation_euler = (0, -11, 0), (math.pi / 2, 0, 0)
c.data.clip_end = 1e6
cube = bpy.data.objects['Cube']
def plane(name, y, size, x=0):
    m = bpy.data.meshes.new(name)
    m.from_pydata([(-size, 0, -size), (size, 0, -size), (size, 0, size), (-size, 0, size)], [], [(0, 1, 2, 3)])
    o = bpy.data.objects.new(name, m)
    o.location = (x, y, 0)
    s.collection.objects.link(o)
    return o
"""


def recorded(tmp_path, name, script, *options, samples=2):
    make_blend(tmp_path / (name + ".blend"), START + script)
    done = record("--blend", tmp_path / (name + ".blend"), "--samples", samples, *options, "-o", tmp_path / name)
    assert done.returncode == 0, done.stderr
    return Folder(tmp_path / name)


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("plain"), "plain", "")


def changes(folder):
    return " | ".join(folder.recording["scene"].get("changes", []))


@pytest.mark.parametrize("path, script", [
    ("cycles.seed", "s.driver_add('cycles.seed').driver.expression = 'frame'"),
    ("cycles.samples", "s.cycles.samples = 9\ns.keyframe_insert('cycles.samples', frame=1)"),
    ("cycles.seed", """
s.keyframe_insert('cycles.seed', frame=1)
data = s.animation_data
data.nla_tracks.new().strips.new('strip', 1, data.action)
data.action = None"""),
    ("render.film_transparent", "s.render.film_transparent = True\ns.keyframe_insert('render.film_transparent', frame=1)"),
    ('view_layers["ViewLayer"].samples', "v = s.view_layers[0]\nv.samples = 7\nv.keyframe_insert('samples', frame=1)"),
    ("mist_settings.depth", "s.world.mist_settings.depth = 2\ns.world.mist_settings.keyframe_insert('depth', frame=1)")])
def test_what_moves_a_setting_of_the_recorder_is_muted_and_told(tmp_path, plain, path, script):
    moved = recorded(tmp_path, "moved", script)
    assert "animated or driven, and set by the recorder instead: %s" % path in changes(moved)
    assert moved.files() == plain.files() and len(set(plain.files().values())) == 2


def test_a_camera_bound_to_a_marker_stands_where_the_frame_says_or_the_option(tmp_path):
    script = """
far = bpy.data.objects.new('Far', c.data)
far.location, far.rotation_euler = (0, -21, 0), c.rotation_euler
s.collection.objects.link(far)
for name, frame, camera in (('one', 1, c), ('two', 10, far)):
    s.timeline_markers.new(name, frame=frame).camera = camera
s.frame_set(1)
"""
    make_blend(tmp_path / "s.blend", START + script)
    for number, (options, camera, distance) in enumerate([
            ((), "Camera", 10), (("--frame", "10"), "Far", 20), (("--camera", "Far"), "Far", 20),
            (("--camera", "Far", "--frame", "1"), "Far", 20), (("--camera", "Camera", "--frame", "10"), "Camera", 10)]):
        done = record("--blend", tmp_path / "s.blend", "--samples", "1", *options, "-o", tmp_path / str(number))
        assert done.returncode == 0, done.stderr
        folder = Folder(tmp_path / str(number))
        assert folder.recording["camera"] == camera
        assert abs(folder.plane("pass_00000.f32", "depth.Z")[6, 8] - distance) < 0.1


@pytest.mark.parametrize("script", [
    "plane('wall', 65, 90).hide_viewport = True",
    "k = bpy.data.collections.new('k')\ns.collection.children.link(k)\n"
    "o = plane('wall', 65, 90)\ns.collection.objects.unlink(o)\nk.objects.link(o)\nk.hide_viewport = True",
    "o = plane('wall', 5, 3, -8)\nm = o.modifiers.new('a', 'ARRAY')\nm.count = 2\n"
    "m.use_relative_offset, m.use_constant_offset = False, True\nm.constant_offset_displace = (8, 60, 0)\nm.show_viewport = False"])
def test_what_only_the_viewport_hides_has_its_depth(tmp_path, script):
    folder = recorded(tmp_path, "s", "cube.location.z = -8\n" + script, samples=1)
    assert abs(folder.plane("pass_00000.f32", "depth.Z")[6, 8] - 76) < 1


@pytest.mark.skipif(not os.path.exists(SPOOL), reason="NOT TESTED: the program spool is not built")
@pytest.mark.parametrize("options", [(), ("--mode", "shift")])
def test_a_depth_that_16_bits_cannot_hold_is_recorded_in_32(tmp_path, options):
    make_blend(tmp_path / "s.blend", START + "plane('wall', 80000, 90000)")
    done = run(tmp_path / "s.blend", "--samples", "2", *options, "-o", tmp_path / "s.spool")
    assert done.returncode in (0, 1) and (tmp_path / "s.spool").exists(), done.stderr     # a bare wall may fail the test of the picture
    told = json.loads(subprocess.run([SPOOL, "info", tmp_path / "s.spool", "--json"], capture_output=True, text=True).stdout)
    types = {layer["name"]: layer["type"] for layer in told["layers"]}
    assert types["depth"] == "f32" and types["normal"] == "f16", types


def test_a_depth_that_mixes_distances_says_so(tmp_path, plain):
    assert "mixed" not in changes(plain) and "mixed" not in plain.recording["layers"]["depth"]["note"]
    glass = "cube.active_material.node_tree.nodes['Principled BSDF'].inputs['Alpha'].default_value = 0.5"
    clear = recorded(tmp_path, "clear", glass, samples=1)
    assert "the layer depth is mixed with its reach" in changes(clear) and "mixed with its reach" in clear.recording["layers"]["depth"]["note"]
    shift = recorded(tmp_path, "shift", glass, "--mode", "shift", samples=1)
    assert "mixed" not in changes(shift)


def test_an_object_of_an_instanced_collection_has_its_number(tmp_path):
    folder = recorded(tmp_path, "s", """
k = bpy.data.collections.new('k')
k.objects.link(cube)
s.collection.children['Collection'].objects.unlink(cube)
e = bpy.data.objects.new('Instance', None)
e.instance_type, e.instance_collection = 'COLLECTION', k
s.collection.objects.link(e)
""", "--mode", "shift", "--channels", "object", samples=1)
    assert folder.plane("pass_00000.f32", "object.ID")[6, 8] == 2                 # Camera, Cube, Instance, Light

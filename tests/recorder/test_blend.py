"""Scenes of other people: files that are not there are refused before anything is rendered, what is overridden is told."""
import json
import subprocess

import pytest
from conftest import Folder, one_line, record
from test_record import make_blend
from test_script import SPOOL, run

# A texture (and an image that no picture shows), a light profile; then a library and a cache.
NAMED = """
import os
T = %r
s = bpy.context.scene
s.render.engine = 'CYCLES'
s.render.resolution_x, s.render.resolution_y = 24, 16
i = bpy.data.images.new('x', 4, 4)
for name in ('tex.png', 'brush.png', 'other.png'):
    i.filepath_raw, i.file_format = T + '/' + name, 'PNG'
    i.save()
tree = bpy.data.objects['Cube'].active_material.node_tree
node = tree.nodes.new('ShaderNodeTexImage')
node.image = bpy.data.images.load(T + '/tex.png')
tree.links.new(node.outputs[0], tree.nodes['Principled BSDF'].inputs['Base Color'])
stencil = bpy.data.images.load(T + '/brush.png')
stencil.use_fake_user = True
light = tree.nodes.new('ShaderNodeTexIES')
light.mode, light.filepath = 'EXTERNAL', '//lamp.ies'
"""
REST = """
other = bpy.data.objects.new('away', bpy.data.meshes.new('away'))
bpy.data.libraries.write(T + '/lib.blend', {other})
with bpy.data.libraries.load(T + '/lib.blend', link=True) as (there, taken):
    taken.objects = ['away']
s.collection.objects.link(taken.objects[0])
cache = bpy.data.objects['Cube'].modifiers.new('c', 'MESH_CACHE')
cache.filepath = '//cube.mdd'
bpy.ops.wm.save_as_mainfile(filepath=T + '/s.blend')
for name in ('tex.png', 'brush.png', 'lib.blend'):
    os.remove(T + '/' + name)
"""
ASKS = """
s = bpy.context.scene
s.render.engine = 'CYCLES'
s.render.resolution_x, s.render.resolution_y = 16, 16
s.render.use_border, s.render.use_crop_to_border, s.render.border_max_x = True, True, 0.5
s.render.use_multiview = s.render.film_transparent = s.cycles.use_denoising = s.use_nodes = True
s.view_layers.new('Other')
s.node_tree.nodes.new('CompositorNodeBlur')
"""


def test_what_is_not_there_is_listed_before_anything_is_rendered(tmp_path):
    make_blend(tmp_path / "s.blend", (NAMED + REST) % str(tmp_path))
    done = record("--blend", tmp_path / "s.blend", "--samples", "1", "-o", tmp_path / "passes")
    told = one_line(done.stderr)
    assert done.returncode == 1 and "s.blend: 4 of the 4 files it names cannot be used: " in told
    for name in ("texture //tex.png", "library //lib.blend", "light profile //lamp.ies", "cache //cube.mdd", "--substitute NAME=FILE"):
        assert name in told
    assert "brush.png" not in told and not (tmp_path / "passes").exists()


def test_what_stands_for_a_file_is_used_and_told(tmp_path):
    make_blend(tmp_path / "s.blend", NAMED % str(tmp_path) + "os.remove(T + '/tex.png')\nopen(T + '/lamp.ies', 'w').close()")
    options = ("--blend", tmp_path / "s.blend", "--samples", "1", "-o", tmp_path / "passes")
    for substitute, code, words in (("gone.png=" + str(tmp_path / "other.png"), 2, "--substitute gone.png: the scene names no such file"),
                                    ("tex.png=nowhere.png", 2, "nowhere.png: no such file"), ("tex.png", 2, "write NAME=VALUE"),
                                    ("tex.png=" + str(tmp_path / "lamp.ies"), 1, "not an image that Blender reads")):
        done = record(*options, "--substitute", substitute)
        assert done.returncode == code and words in one_line(done.stderr)
    done = record(*options, "--substitute", "tex.png=%s" % (tmp_path / "other.png"))
    assert done.returncode == 0 and "s.blend: tex.png replaced by other.png, as asked" in done.stderr
    folder = Folder(tmp_path / "passes")
    assert "tex.png replaced by other.png, as asked" in folder.recording["scene"]["changes"]
    red, green = (folder.plane("pass_00000.f32", "radiance." + channel)[8, 12] for channel in "RG")
    assert red == green                      # black, not magenta


@pytest.mark.parametrize("engine", ["CYCLES", "BLENDER_EEVEE"])
def test_what_a_scene_asks_for_and_is_not_done_is_told_line_by_line(tmp_path, engine):
    make_blend(tmp_path / "s.blend", ASKS + "s.render.engine = %r" % engine)
    done = record("--blend", tmp_path / "s.blend", "--samples", "1", "-o", tmp_path / "passes")
    assert done.returncode == 0, done.stderr
    told = Folder(tmp_path / "passes").recording["scene"]["changes"]
    words = ["render border 0..0.5 x 0..1 and its crop", "stereo", "only the view layer ViewLayer is recorded, not Other", "transparent film", "compositor"]
    words += ["denoiser", "adaptive sampling, clamp of indirect light"] if engine == "CYCLES" else ["made for BLENDER_EEVEE"]
    assert len(told) == len(words) and all(sum(word in line for line in told) == 1 for word in words), told
    assert [line for line in done.stderr.splitlines() if line.startswith("s.blend: ")] == ["s.blend: " + line for line in told]


def test_several_recordings_share_the_reference_and_no_seed_and_are_a_group(tmp_path):
    done = run("chess", "--size", "16", "--samples", "8", "--recordings", "2", "--reference", "64", "-o", tmp_path / "b.spool")
    assert done.returncode == 0, done.stderr
    files = [tmp_path / "b_1.spool", tmp_path / "b_2.spool"]
    assert sorted(tmp_path.iterdir()) == files
    assert "b_1.spool: " in done.stdout and "claims on the samples hold, 0 fail" in done.stdout
    assert done.stdout.splitlines()[-1].startswith("next: spool evaluate %s %s --spp" % tuple(files))
    first, second = (json.loads(subprocess.run([SPOOL, "info", path, "--json"], capture_output=True, text=True).stdout) for path in files)
    assert first["samples_per_pixel"] == second["samples_per_pixel"] == 4 and first["verified"] and second["verified"]
    assert first["meta"]["group"] == {**second["meta"]["group"], "recording": 1} and second["meta"]["group"]["of"] == 2
    assert not set(first["meta"]["seeds"]) & set(second["meta"]["seeds"])
    assert first["meta"]["reference"] == second["meta"]["reference"]
    plan = tmp_path / "results" / "plan.toml"
    judged = subprocess.run([SPOOL, "evaluate", *files, "--spp", "2", "--replicates", "2", "--no-pictures", "-o", plan.parent, "-q"],
                            capture_output=True, text=True)
    assert judged.returncode == 0, judged.stderr
    assert plan.read_text().count("group = 'b-%s'" % first["meta"]["group"]["id"]) == 2
    assert run("chess", "--recordings", "2", "--samples", "8", "-o", tmp_path / "b.spool").returncode == 2


@pytest.mark.parametrize("options, words", [(("--samples", "9"), "9 samples do not split into 2 equal parts"),
                                            (("--mode", "sequence"), "the samples of a sequence belong together")])
def test_what_does_not_split_is_refused(tmp_path, options, words):
    done = record("--scene", "balls", "--recordings", "2", *options, "-o", tmp_path / "passes")
    assert done.returncode == 2 and words in one_line(done.stderr)

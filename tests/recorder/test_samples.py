"""Are the recorded samples right: position in the pixel, independence, and mean against the reference."""
import subprocess

import pytest
from conftest import Folder, record

# A plane with a colour ramp seen straight from above by an orthographic camera, one unit a pixel:
# radiance R and G are the position on the film, and their fraction is the position in the pixel.
RULER = """
s = bpy.context.scene
for o in list(s.objects): bpy.data.objects.remove(o)
s.world.use_nodes = False
s.world.color = (0, 0, 0)
W, H = 24, 16
m = bpy.data.meshes.new('sheet')
m.from_pydata([(-99, -99, 0), (99, -99, 0), (99, 99, 0), (-99, 99, 0)], [], [(0, 1, 2, 3)])
mat = bpy.data.materials.new('ruler')
mat.use_nodes = True
t = mat.node_tree
t.nodes.clear()
out, emit = t.nodes.new('ShaderNodeOutputMaterial'), t.nodes.new('ShaderNodeEmission')
geo = t.nodes.new('ShaderNodeNewGeometry')
add = t.nodes.new('ShaderNodeVectorMath')
add.inputs[1].default_value = (W / 2, H / 2, 0)
t.links.new(geo.outputs['Position'], add.inputs[0])
t.links.new(add.outputs[0], emit.inputs['Color'])
t.links.new(emit.outputs[0], out.inputs['Surface'])
m.materials.append(mat)
s.collection.objects.link(bpy.data.objects.new('sheet', m))
c = bpy.data.cameras.new('above')
c.type, c.ortho_scale, c.sensor_fit = 'ORTHO', %(scale)d, '%(fit)s'
o = bpy.data.objects.new('above', c)
o.location = (0, 0, 5)
s.collection.objects.link(o)
s.camera = o
s.render.engine = 'CYCLES'
s.render.resolution_x, s.render.resolution_y = W, H
"""


def make_ruler(path, fit):
    script = RULER % {"fit": fit, "scale": 16 if fit == "VERTICAL" else 24}
    done = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "3", "--python-expr",
                           "import bpy\n%s\nbpy.ops.wm.save_as_mainfile(filepath=%r)" %
                           (script, str(path))], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr


def positions(folder, name):
    """Position in the pixel as seen by the picture: [y][x] of x and of y (y down)."""
    import numpy
    height, width = folder.recording["height"], folder.recording["width"]
    x = folder.plane(name, "radiance.R") - numpy.arange(width)[None, :]
    y = height - folder.plane(name, "radiance.G") - numpy.arange(height)[:, None]
    return x, y


@pytest.mark.parametrize("fit", ["AUTO", "VERTICAL"])
def test_shift_mode_puts_samples_where_it_says(fit, tmp_path):
    make_ruler(tmp_path / "ruler.blend", fit)
    done = record("--blend", tmp_path / "ruler.blend", "--samples", "6", "--mode", "shift",
                  "--channels", "radiance,position", "-o", tmp_path / "passes")
    assert done.returncode == 0, done.stderr
    folder = Folder(tmp_path / "passes")
    for entry in folder.entries:
        x, y = positions(folder, entry["file"])
        assert abs(x - entry["film"][0]).max() < 2e-4
        assert abs(y - entry["film"][1]).max() < 2e-4


@pytest.mark.parametrize("mode", ["iid", "sequence"])
def test_positions_fill_the_pixel_evenly(mode, tmp_path):
    import numpy
    make_ruler(tmp_path / "ruler.blend", "AUTO")
    done = record("--blend", tmp_path / "ruler.blend", "--samples", "16", "--mode", mode,
                  "--channels", "radiance", "-o", tmp_path / "passes")
    assert done.returncode == 0, done.stderr
    folder = Folder(tmp_path / "passes")
    for axis in (0, 1):
        values = numpy.stack([positions(folder, e["file"])[axis] for e in folder.entries])
        assert -1e-4 < values.min() and values.max() < 1 + 1e-4
        counts = numpy.histogram(values.clip(0, 1), 8, (0, 1))[0]
        expected = values.size / 8
        chi = ((counts - expected) ** 2 / expected).sum()
        # 7 degrees of freedom: 30 is exceeded with probability 1e-4
        assert chi < 30
        if mode == "sequence":
            # 16 samples of a (0, 2)-sequence: one in each sixteenth. Cycles' filter table stretches
            # positions (y up) by 1023 / 1022 and puts one draw in 1023 anywhere: 1.6 % of the pixels
            # have such a sample. Independent samples would give 0.2.
            drawn = (values if axis == 0 else 1 - values) * 1022 / 1023
            strata = numpy.sort((drawn * 16).astype(int).clip(0, 15), axis=0)
            assert (strata == numpy.arange(16)[:, None, None]).mean() > 0.97


@pytest.mark.parametrize("mode, width, height", [("shift", 24, 16), ("iid", 64, 48)])
def test_mean_of_the_samples_agrees_with_the_reference(mode, width, height, tmp_path):
    """Squared error of the mean against its predicted variance, both summed over the picture: a
    chi-square law with the number of pixels that really take part."""
    import numpy
    blend = tmp_path / "cube.blend"
    done = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "3",
                           "--python-expr",
                           "import bpy\nbpy.ops.wm.save_as_mainfile(filepath=%r)" % str(blend)],
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0
    done = record("--blend", blend, "--size", "%dx%d" % (width, height), "--samples", "128", "--mode",
                  mode, "--reference", "2048", "--channels", "radiance", "-o", tmp_path / "passes")
    assert done.returncode == 0, done.stderr
    folder = Folder(tmp_path / "passes")

    def stack(kind):
        return numpy.stack([folder.plane(e["file"], "radiance.G") for e in folder.entries
                            if e["kind"] == kind]).astype(float)

    pool, batches = stack("pass"), stack("reference")
    variance = pool.var(0, ddof=1) / len(pool) + batches.var(0, ddof=1) / len(batches)
    ratio = ((pool.mean(0) - batches.mean(0)) ** 2).sum() / variance.sum()
    freedom = variance.sum() ** 2 / (variance ** 2).sum()
    if mode == "shift":
        freedom /= 2               # one position for all pixels: their errors are not independent
    assert freedom > 8
    # Wilson and Hilferty's normal form of chi-square; 3.9 is exceeded with probability 1e-4
    z = (ratio ** (1 / 3) - (1 - 2 / (9 * freedom))) / (2 / (9 * freedom)) ** 0.5
    assert abs(z) < 3.9, (ratio, freedom)


LIT = """
s = bpy.context.scene
s.render.engine = 'CYCLES'
m = bpy.data.objects['Cube'].data.materials[0]
b = next(n for n in m.node_tree.nodes if n.type == 'BSDF_PRINCIPLED')
b.inputs['Roughness'].default_value, b.inputs['Metallic'].default_value = 0.25, 0.4
bpy.data.objects['Light'].data.type = 'AREA'
bpy.data.objects['Light'].data.size = 4
me = bpy.data.meshes.new('floor')
me.from_pydata([(-9, -9, -1), (9, -9, -1), (9, 9, -1), (-9, 9, -1)], [], [(0, 1, 2, 3)])
me.materials.append(m)
s.collection.objects.link(bpy.data.objects.new('floor', me))
"""


def test_direct_light_is_the_radiance_of_paths_cut_after_one_surface(tmp_path):
    import numpy
    for name, cut in (("whole", ""), ("cut", "s.cycles.max_bounces = 0\n")):
        blend = tmp_path / (name + ".blend")
        done = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "3", "--python-expr",
                               "import bpy\n%s%s\nbpy.ops.wm.save_as_mainfile(filepath=%r)" %
                               (LIT, cut, str(blend))], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stdout + done.stderr
        done = record("--blend", blend, "--size", "24x16", "--samples", "8", "--mode", "shift", "--channels",
                      "radiance,direct", "-o", tmp_path / name)
        assert done.returncode == 0, done.stderr
    whole, cut = Folder(tmp_path / "whole"), Folder(tmp_path / "cut")
    for entry in whole.entries:
        for component in "RGB":
            direct = whole.plane(entry["file"], "direct." + component)
            radiance = whole.plane(entry["file"], "radiance." + component)
            alone = cut.plane(entry["file"], "radiance." + component)
            assert numpy.allclose(direct, alone, rtol=1e-4, atol=1e-5)
            assert (radiance - direct > -1e-5).all() and (radiance - direct).max() > 0.01

"""The fallback without LLVM: numbers of its own for chunks, pool and reference, and the features of the wavefront."""
import math

import numpy as np
import pytest

import spool
from conftest import check_ok, record
from dumps.mitsuba.seeds import CHUNK_LIMIT, USER_LIMIT, chunk_seed, spread


def test_seeds_of_chunks_are_all_different_and_spread_keeps_them_so():
    few = [chunk_seed(user, chunk, reference) for user in (0, 1, USER_LIMIT - 1) for reference in (False, True)
           for chunk in [*range(2000), CHUNK_LIMIT - 2, CHUNK_LIMIT - 1]]
    assert len(set(few)) == len(few) and max(few) < 1 << 31
    assert len({spread(seed) for seed in few}) == len(few)
    assert spread(0) == 0 and spread(1) == 0x514E28B7         # MurmurHash3's finaliser, computed by hand from its definition


@pytest.mark.parametrize("size", [32, 30])
def test_seeds_differ_and_pool_and_reference_differ(tmp_path, size):
    """32 x 32 pixels: a product of size and seed distance once came to a multiple of 2^32."""
    pools, references = [], []
    for seed in (1, 2):
        out = tmp_path / ("%d.spool" % seed)
        check_ok(record("cornell-box", "-o", out, "--size", size, "--samples", 4, "--reference", 4, "--seed", seed,
                        "--variant", "scalar_rgb", "--channels", "film", "--max-depth", 3, "--chunk-lanes", size * size * 2))
        with spool.open(out) as dump:
            assert dump.meta["random_numbers"] == {"pool": size * size * 4, "pool_repeated": 0,
                                                   "reference": size * size * 4, "reference_repeated": 0}
            pools.append(dump.read("film"))
            references.append(dump.pixel("reference") - dump.read("radiance").mean(axis=2))
    assert (pools[0] != pools[1]).mean() > 0.999
    assert (pools[0][:, :, :2] != pools[0][:, :, 2:]).mean() > 0.999       # the second chunk
    assert all((np.abs(difference) > 1e-4).mean() > 0.5 for difference in references)


ROW = """<scene version="3.0.0"><integrator type="path"/><sensor type="perspective">
<float name="fov" value="%g"/><transform name="to_world"><lookat origin="0,0,-99" target="0,0,0" up="0,1,0"/></transform></sensor>
<emitter type="constant"/>%s</scene>"""


BARE = '<shape type="sphere"><point name="center" x="%d" y="0" z="0"/>%s</shape>'
INSTANCE = '<shape type="shapegroup" id="group%d"><shape type="sphere">%s</shape></shape><shape type="instance">' \
    '<transform name="to_world"><translate x="%d"/></transform><ref id="group%d"/></shape>'


def row_of_spheres(folder, materials, variant, instances=False):
    """[(shape, albedo)] of the middle of each of the spheres, which have no id."""
    scene, out, wide = folder / "row.xml", folder / ("%s.spool" % variant), len(materials)
    places = [wide - 1 - 2 * i for i in range(wide)]               # +x of this camera is on the left
    spheres = "".join(INSTANCE % (i, materials[i], x, i) if instances else BARE % (x, materials[i]) for i, x in enumerate(places))
    scene.write_text(ROW % (2 * math.degrees(math.atan(wide / 99)), spheres))
    result = record(scene, "-o", out, "--size", "%dx3" % (3 * wide), "--samples", 2, "--channels", "shape,albedo", "--no-verify",
                    "--variant", variant)
    if variant != "scalar_rgb" and result.returncode == 3:
        pytest.skip("no LLVM here")
    check_ok(result)
    with spool.open(out) as dump:
        shape, albedo = dump.read("shape")[1, 1::3, 0, 0], dump.read("albedo")[1, 1::3, 0]
        assert instances or dump.meta["scene"]["shapes"] == [""] * wide
    return [(int(one), [round(float(value), 2) for value in two]) for one, two in zip(shape, albedo)]


BLACK = '<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>'
GREY = '<bsdf type="diffuse"/>'
MIRROR = '<bsdf type="conductor"/>'
BLEND = '<bsdf type="blendbsdf"><float name="weight" value="0.5"/>%s%s</bsdf>'


@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "scalar_rgb"])
@pytest.mark.parametrize("instances", [False, True])
def test_shapes_without_an_id_are_told_apart_and_albedo_is_1_without_a_diffuse_answer(tmp_path, variant, instances):
    plastic = '<bsdf type="plastic"><rgb name="diffuse_reflectance" value="%s"/></bsdf>'
    materials = ['<bsdf type="dielectric"/>', GREY, BLACK, MIRROR, BLEND % (BLACK, MIRROR), BLEND % (BLACK, BLACK),
                 plastic % "0", plastic % "0, 0.25, 0"]
    found = row_of_spheres(tmp_path, materials, variant, instances)
    shapes = [shape for shape, _ in found]
    assert shapes == sorted(set(shapes)) if instances else shapes == [1, 2, 3, 4, 5, 6, 7, 8]
    assert [albedo for _, albedo in found] == [[1] * 3, [0.5] * 3, [0] * 3, [1] * 3, [1] * 3, [0] * 3, [1] * 3, [0, 0.25, 0]]

"""Scenes as they are found: what is lost, missing or misspelt is said."""
import os

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="MITSUBA IS NOT INSTALLED: its recorder is NOT tested")

import spool
from dumps.mitsuba.channels import chosen_layers
from dumps.mitsuba.output import light_too_wide
from conftest import BALL, CAMERA, FILM, LIGHT, OLD, check_ok, record, refusal, told

NEW = '<integrator type="path"/>' + CAMERA % FILM + LIGHT + BALL


def test_size_holds_without_a_film(load):
    found = load('<integrator type="path"/>' + CAMERA % "" + LIGHT + BALL % "", "3.0.0", size=(48, 40))
    assert tuple(found.sensor.film().crop_size()) == (48, 40)
    found = load('<integrator type="path"/>' + CAMERA % "" + LIGHT + BALL % "", "3.0.0")
    assert tuple(found.sensor.film().crop_size()) == (768, 576)


def test_another_aspect_is_remarked_and_the_same_is_not(load):
    assert "another aspect than the film's 24x16" in told(load(NEW % "", "3.0.0", size=(32, 32)))
    assert load(NEW % "", "3.0.0", size=(12, 8)).changes == []


def test_a_crop_window_and_further_sensors_are_remarked(load):
    old = FILM.replace("</film>", '<integer name="cropWidth" value="8"/><integer name="cropHeight" value="8"/></film>')
    assert "crop window of 8x8" in told(load(OLD % "path" + CAMERA % old + LIGHT + BALL % ""))
    crop = FILM.replace("</film>", '<integer name="crop_width" value="8"/><integer name="crop_height" value="%d"/></film>')
    found = load(NEW.replace(FILM, crop % 8) % "", "3.0.0")
    assert found.changes == ["the film's crop window of 8x8 is not kept: the whole picture of 24x16 is recorded"]
    assert tuple(found.sensor.film().crop_size()) == (24, 16)
    assert load(NEW.replace(FILM, crop.replace("8", "24") % 16) % "", "3.0.0").changes == []
    second = (CAMERA % FILM.replace("24", "12")).replace("40", "20")
    found = load(NEW % "" + second, "3.0.0")
    assert found.changes == ["the scene has 2 sensors: only the first is recorded"]
    assert tuple(found.sensor.film().crop_size()) == (24, 16) and "x_fov = 40" in str(found.sensor)


@pytest.mark.parametrize("name, words", [("lens", "has no aperture"), ("time", "open for no time"), ("direct", "only the path integrator")])
def test_a_layer_that_the_scene_has_not_is_refused_when_named(load, name, words):
    found = load((NEW % "").replace('"path"', '"volpath"'), "3.0.0")
    code, text = refusal(chosen_layers, "radiance,%s" % name, found)
    assert code == 1 and words in text and "leave out `%s`" % name in text
    assert name not in chosen_layers("all", found)


def test_max_depth_reaches_the_integrator_of_the_scene(load):
    assert "max_depth = 3" in str(load(NEW % "", "3.0.0", max_depth=3).integrator)
    assert "max_depth = 7" in str(load(NEW % "", "3.0.0", max_depth=7, integrator="volpath").integrator)


def test_a_scene_without_an_integrator_gets_one(load):
    found = load(CAMERA % FILM + LIGHT + BALL % "", "3.0.0", max_depth=4)
    assert "no integrator: path is used" in told(found) and "max_depth = 4" in str(found.integrator)
    medium = '<medium type="homogeneous" name="interior"/>'
    assert "volpath is used" in told(load(CAMERA % FILM + LIGHT + BALL % medium, "3.0.0"))


def test_media_that_the_integrator_does_not_see_are_remarked(load):
    found = load(NEW % '<bsdf type="null"/><medium type="homogeneous" name="interior"/>', "3.0.0")
    assert "volumes, which its integrator does not see" in told(found)


def test_misspelt_parameters_are_refused_with_the_right_ones(load):
    body = '<default name="colour" value="0.5"/>' + NEW % '<bsdf type="diffuse"><float name="reflectance" value="$colour"/></bsdf>'
    load(body, "3.0.0", definitions={"colour": "0.2"})
    code, text = refusal(load, body, "3.0.0", definitions={"color": "0.2"})
    assert code == 2 and "-D color" in text and "it has colour" in text
    code, text = refusal(load, body.replace("<default", "<!--").replace('"0.5"/>', "-->"), "3.0.0")
    assert code == 2 and "give -D colour=VALUE" in text


def test_undefined_parameters_are_named_all_at_once(load, tmp_path):
    (tmp_path / "part.xml").write_text('<scene version="3.0.0"><default name="wide" value="1"/><!-- $nothing -->'
                                       '<shape type="sphere"><float name="radius" value="$radius"/></shape></scene>')
    ball = NEW % '<bsdf type="diffuse"><rgb name="reflectance" value="$r,$g,$wide"/></bsdf>'
    code, text = refusal(load, '<include filename="part.xml"/>' + ball, "3.0.0", definitions={"g": "1"})
    assert code == 2 and "uses the parameters r, radius without a value: give -D r=VALUE -D radius=VALUE" in text


def test_integrators_that_give_features_alone_are_refused(load):
    features = '<integrator type="aov"><string name="aovs" value="d:depth"/>%s</integrator>' + CAMERA % FILM + LIGHT + BALL % ""
    load(features % '<integrator type="path"/>', "3.0.0")
    load(features % "", "3.0.0", integrator="path")
    for text, wishes in ((features % "", {}), (CAMERA % FILM + LIGHT, {"integrator": "moment"}), (NEW % "", {"integrator": "moment"})):
        code, told_text = refusal(load, text, "3.0.0", **wishes)
        assert code == 1 and "has no integrator inside" in told_text and "--integrator path" in told_text


def test_dropped_properties_are_named(load):
    found = load(NEW % '<bsdf type="diffuse"><float name="shininess" value="3"/></bsdf>', "3.0.0")
    assert "lost: bsdf diffuse does not know shininess, line 2" in told(found)


def test_dropped_properties_of_the_camera_are_named_with_a_film_and_without(load):
    lens = '<float name="aperture_radius" value="0.1"/><float name="focal_distance" value="4"/>'
    for film in (FILM, ""):
        body = '<integrator type="path"/>' + (CAMERA % (film + lens)).replace('"perspective"', '"thinlens"') + LIGHT + BALL % ""
        assert "lost: sensor thinlens does not know focal_distance" in told(load(body, "3.0.0", size=(24, 16)))


def test_an_orthographic_camera_keeps_its_scale(load):
    camera = (CAMERA % FILM).replace('"perspective"', '"orthographic"').replace(
        "<lookAt", '<scale x="3" y="2"/><lookAt').replace('<float name="fov" value="40"/>', "")
    found = load('<integrator type="path"/>' + camera + LIGHT + BALL % "", "3.0.0")
    assert found.changes == []
    assert np.linalg.norm(np.array(found.sensor.world_transform().matrix).reshape(4, 4)[:3, 0]) == pytest.approx(3)


@pytest.mark.parametrize("medium, words", [
    ('<medium type="homogeneous" name="interior"><string name="density_filename" value="scene.xml"/></medium>', "does not know density_filename"),
    ('<medium type="homogeneous" name="interior"><rgb name="sigma_s" value="1"/></medium>', "medium homogeneous does not know sigma_s"),
    ('<medium type="heterogeneous" name="interior"><volume type="constvolume" name="thickness"><float name="value" value="2"/></volume>'
     '</medium>', "thickness")])
def test_a_medium_that_loses_something_is_refused_unless_allowed(load, medium, words):
    body = (NEW % medium).replace('"path"', '"volpath"')
    code, text = refusal(load, body, "3.0.0")
    assert code == 1 and words in text and "--allow-losses" in text
    assert words in told(load(body, "3.0.0", allow_losses=True))


def test_missing_files_are_named_all_at_once(load, tmp_path):
    body = NEW % "" + '<shape type="obj"><string name="filename" value="a.obj"/></shape><shape type="ply"><string name="filename" ' \
        'value="b.ply"/><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="c.png"/>' \
        '</texture></bsdf></shape>'
    code, text = refusal(load, body, "3.0.0")
    assert code == 1 and "3 of the 3 files it names are not there: a.obj, b.ply, c.png" in text
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    only = NEW % "" + '<shape type="obj"><string name="filename" value="a.obj"/></shape>'
    first = load(only, "3.0.0", folders=(str(tmp_path / "meshes"),))
    (tmp_path / "meshes" / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n")
    assert first.digest != load(only, "3.0.0", folders=(str(tmp_path / "meshes"),)).digest


DICT = """def scene(mi):
    return {"type": "scene", "integrator": {"type": "path"}, "sensor": {"type": "perspective"}, "light": {"type": "constant"}, %s}
"""


def test_the_files_and_plugins_of_a_python_scene_are_named_and_hashed_too(load, tmp_path):
    def written(parts, **wishes):
        (tmp_path / "scene.py").write_text(DICT % parts)
        return load_scene(mi, str(tmp_path / "scene.py"), Wishes(**wishes))

    from dumps.mitsuba.scene import Wishes, load_scene
    mesh = '"a": {"type": "obj", "filename": "mesh.obj"}'
    code, text = refusal(written, mesh + ', "b": {"type": "ply", "filename": "other.ply"}')
    assert code == 1 and "2 of the 2 files it names are not there: mesh.obj, other.ply" in text
    code, text = refusal(written, '"a": {"type": "sphere", "m": {"type": "glass"}}, "b": {"type": "sphere", "m": {"type": "irawan"}}')
    assert code == 1 and "no plugin glass, no plugin irawan" in text and "--substitute glass=PLUGIN" in text
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    first = written(mesh).digest
    assert first == written(mesh).digest
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n")
    assert first != written(mesh).digest


def test_unknown_plugins_are_named_and_can_be_substituted(load):
    body = NEW % '<bsdf type="glass"/>' + BALL.replace("ball", "b") % '<bsdf type="irawan"/>'
    code, text = refusal(load, body, "3.0.0")
    assert code == 1 and "no bsdf glass, no bsdf irawan" in text and "--substitute glass=PLUGIN" in text
    found = load(body, "3.0.0", substitutes={"glass": "dielectric", "irawan": "diffuse"})
    assert "glass replaced by dielectric" in told(found)
    assert refusal(load, NEW % "", "3.0.0", substitutes={"glass": "dielectric"})[0] == 2


def test_another_scene_than_the_expected_one_is_refused(load):
    digest = load(NEW % "", "3.0.0").digest
    load(NEW % "", "3.0.0", digest=digest)
    code, text = refusal(load, NEW % '<bsdf type="plastic"/>', "3.0.0", digest=digest)
    assert code == 1 and "another scene than" in text


def test_a_camera_that_scales_keeps_its_rotation(load):
    body = '<integrator type="path"/>' + CAMERA.replace("</transform>", '<scale value="2"/></transform>') % FILM + LIGHT + BALL % ""
    found = load(body, "3.0.0")
    matrix = np.array(found.sensor.world_transform().matrix).reshape(4, 4)
    assert np.linalg.svd(matrix[:3, :3], compute_uv=False) == pytest.approx([1, 1, 1], abs=1e-5)
    assert matrix[:3, 3] == pytest.approx([0, 0, -8])          # where the scaled transform puts it
    assert "only its rotation is used" in told(found)


def test_changes_are_told_and_stand_in_the_file(tmp_path):
    (tmp_path / "old").mkdir()
    scene, out = tmp_path / "old" / "scene.xml", tmp_path / "old.spool"
    scene.write_text('<scene version="0.5.0">' + OLD % "bdpt" + "<mode/>" + CAMERA % FILM + LIGHT + BALL % (
        '<bsdf type="roughconductor"/>') + "</scene>")
    result = check_ok(record(scene, "-o", out, "--samples", 8, "--half"))
    assert "integrator bdpt taken as path" in result.stderr and "<mode> left out" in result.stderr
    with spool.open(out) as dump:
        assert dump.meta["scene"]["name"] == "old/scene.xml"
        assert "integrator bdpt taken as path" in dump.meta["scene"]["changes"]
        assert "film" not in dump.layers and dump.layers["radiance"].dtype == np.dtype("<f2")
        hit = dump.read("depth")[..., 0] > 0
        assert hit.any() and (dump.read("albedo")[hit] == 1).all() and (dump.read("albedo")[~hit] == 0).all()
    assert not os.path.exists(str(out) + ".recording")


@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "scalar_rgb"])
def test_instances_have_a_shape_a_depth_and_the_material_of_what_they_show(tmp_path, variant):
    scene, out = tmp_path / "instances.xml", tmp_path / "instances.spool"
    instance = '<shape type="instance" id="%s"><transform name="to_world"><translate x="%g"/></transform><ref id="%s"/></shape>'
    group = '<shape type="shapegroup" id="%s"><shape type="sphere"><bsdf type="%s"/></shape></shape>'
    scene.write_text('<scene version="3.0.0"><integrator type="path"/>' + (CAMERA % "").replace("lookAt", "lookat").replace(
        "toWorld", "to_world").replace("-4", "-8") + group % ("g", "dielectric") + group % ("h", "diffuse") + LIGHT + instance % (
        "one", -1.2, "g") + instance % ("two", 1.2, "h") + "</scene>")
    result = record(scene, "-o", out, "--size", "24x12", "--samples", 4, "--channels", "all", "--no-verify", "--variant", variant)
    if variant != "scalar_rgb" and result.returncode == 3:
        pytest.skip("no LLVM here")
    check_ok(result)
    with spool.open(out) as dump:
        shape, depth, albedo = (dump.read(name) for name in ("shape", "depth", "albedo"))
        names = dump.meta["scene"]["shapes"]
        assert set(np.unique(shape)) == {0, 1 + names.index("one"), 1 + names.index("two")}
        assert ((depth[..., 0] > 6) == (shape[..., 0] > 0)).all()
        assert (albedo[shape[..., 0] == 1 + names.index("one")] == 1).all()
        assert albedo[shape[..., 0] == 1 + names.index("two")] == pytest.approx(0.5, abs=1e-3)


def test_half_keeps_what_does_not_fit_in_32_bits(tmp_path):
    scene, out = tmp_path / "bright.xml", tmp_path / "bright.spool"
    scene.write_text('<scene version="3.0.0">' + (CAMERA % FILM).replace("lookAt", "lookat").replace("toWorld", "to_world") +
                     '<emitter type="constant"><float name="radiance" value="1e6"/></emitter>' + BALL % "" + "</scene>")
    result = check_ok(record(scene, "-o", out, "--samples", 8, "--half", "--no-verify"))
    assert "the radiance is kept in 32 bits" in result.stderr
    with spool.open(out) as dump:
        assert dump.layers["radiance"].dtype == np.dtype("<f4") and dump.read("radiance").max() > 9e5


def test_a_dark_scene_is_kept_in_32_bits_and_the_dark_ends_of_paths_are_not(tmp_path):
    dark, out = tmp_path / "dark.xml", tmp_path / "out.spool"
    for light, kind in (("1e-7", "<f4"), ("1", "<f2")):
        dark.write_text('<scene version="3.0.0">' + (CAMERA % FILM).replace("lookAt", "lookat").replace("toWorld", "to_world") +
                        '<emitter type="constant"><float name="radiance" value="%s"/></emitter>' % light + BALL % "" + "</scene>")
        result = check_ok(record(dark, "-o", out, "--samples", 8, "--half", "--no-verify", "--force"))
        assert ("of the light is darker than 6.1e-05: the radiance is kept in 32 bits" in result.stderr) == (kind == "<f4")
        with spool.open(out) as dump:
            assert dump.layers["radiance"].dtype == np.dtype(kind) and dump.read("radiance").max() > 0
    bright = np.full(1000, 0.5, "<f4")
    bright[:300] = 1e-6
    assert light_too_wide([bright]) == "" and light_too_wide([np.zeros(3, "<f4")]) == ""


def test_the_film_is_that_of_the_recorded_sensor(load):
    bare = CAMERA % ""
    second = (CAMERA % FILM.replace("24", "12")).replace("40", "20")
    found = load((NEW % "").replace(CAMERA.replace("lookAt", "lookat").replace("toWorld", "to_world") % FILM, "").replace(CAMERA % FILM, "")
                 + bare + second, "3.0.0")
    assert tuple(found.sensor.film().crop_size()) == (768, 576) and "x_fov = 40" in str(found.sensor)


@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "scalar_rgb"])
def test_depth_is_a_length_for_an_orthographic_camera_that_scales(tmp_path, variant):
    camera = (CAMERA % FILM).replace('"perspective"', '"orthographic"').replace("<lookAt", '<scale value="3"/><lookAt').replace(
        '<float name="fov" value="40"/>', "").replace("lookAt", "lookat").replace("toWorld", "to_world")
    (tmp_path / "s.xml").write_text('<scene version="3.0.0"><integrator type="path"/>' + camera + LIGHT + '<shape type="rectangle"/></scene>')
    check_ok(record(tmp_path / "s.xml", "-o", tmp_path / "s.spool", "--samples", 2, "--no-verify", "--variant", variant))
    with spool.open(tmp_path / "s.spool") as dump:
        depth = dump.read("depth")
        assert sorted({round(float(value), 3) for value in np.unique(depth)}) == [0, 4]


def test_a_grey_albedo_is_grey_where_light_has_wavelengths(tmp_path):
    (tmp_path / "s.xml").write_text('<scene version="3.0.0"><integrator type="path"/>' + (CAMERA % FILM).replace("lookAt", "lookat").replace(
        "toWorld", "to_world") + LIGHT + BALL % '<bsdf type="diffuse"><rgb name="reflectance" value="%s"/></bsdf>' + "</scene>")
    text = (tmp_path / "s.xml").read_text()
    for color in ((0.5, 0.5, 0.5), (0.6, 0.3, 0.2)):
        (tmp_path / "s.xml").write_text(text % ("%g, %g, %g" % color))
        check_ok(record(tmp_path / "s.xml", "-o", tmp_path / "s.spool", "--samples", 4, "--no-verify", "--force", "--variant", "llvm_ad_spectral"))
        with spool.open(tmp_path / "s.spool") as dump:
            albedo, shape = dump.read("albedo").astype(float), dump.read("depth")[..., 0] > 0
            assert np.abs(albedo[shape] - color).max() < 0.005 and not albedo[~shape].any()


@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "scalar_rgb"])
def test_the_moment_in_the_shutter_is_the_number_that_was_drawn(tmp_path, variant):
    """A short shutter, late: out of the time itself only eleven values would come, one of them 1."""
    camera = (CAMERA % (FILM + '<float name="shutter_open" value="10"/><float name="shutter_close" value="10.00001"/>')).replace(
        "lookAt", "lookat").replace("toWorld", "to_world")
    (tmp_path / "s.xml").write_text('<scene version="3.0.0"><integrator type="path"/>' + camera + LIGHT + BALL % "" + "</scene>")
    check_ok(record(tmp_path / "s.xml", "-o", tmp_path / "s.spool", "--samples", 4, "--no-verify", "--variant", variant))
    with spool.open(tmp_path / "s.spool") as dump:
        moment = dump.read("time")
        assert moment.min() >= 0 and moment.max() < 1 and len(np.unique(moment)) > 1000

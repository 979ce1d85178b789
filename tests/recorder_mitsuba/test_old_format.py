"""Scene files of Mitsuba 0.1 to 0.6 mean in Mitsuba 3 what they meant."""
import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="MITSUBA IS NOT INSTALLED: its recorder is NOT tested")

from conftest import BALL, CAMERA, FILM, LIGHT, OLD, refusal, told


@pytest.mark.parametrize("plugin", ["bdpt", "sppm", "pssmlt", "photonmapper", "guided_path", "ptracer"])
def test_old_integrators_become_path(load, plugin):
    found = load(OLD % plugin + CAMERA % FILM + LIGHT + BALL % "")
    assert "integrator %s taken as path" % plugin in told(found) and "max_depth = 6" in str(found.integrator)


def test_old_colours_mean_what_they_meant(load):
    colours = {"one": '<srgb name="reflectance" value="#804020"/>', "two": '<rgb name="reflectance" value="#804020"/>',
               "three": '<srgb name="reflectance" value="0.5, 0.25, 1"/>'}
    body = OLD % "path" + CAMERA % FILM + LIGHT + "".join(
        '<shape type="sphere" id="%s"><bsdf type="diffuse">%s</bsdf></shape>' % item for item in colours.items())
    found = load(body)
    values = {shape.id(): np.array(mi.traverse(shape.bsdf())["reflectance.value"]).ravel() for shape in found.scene.shapes()}
    assert values["one"] == pytest.approx([0.21586, 0.05127, 0.01444], abs=1e-4)     # IEC 61966-2-1
    assert values["two"] == pytest.approx([128 / 255, 64 / 255, 32 / 255], abs=1e-5)
    assert values["three"] == pytest.approx([0.21404, 0.05088, 1], abs=1e-4)


def test_old_emitters_of_one_number_are_grey(load):
    body = OLD % "path" + CAMERA % FILM + BALL % "" + '<emitter type="constant"><spectrum name="radiance" value="2"/></emitter>'
    found = load(body)
    assert np.array(mi.traverse(found.scene)["_unnamed_0.radiance.value"] if "_unnamed_0.radiance.value" in mi.traverse(found.scene)
                    else found.scene.environment().eval(mi.SurfaceInteraction3f())).ravel()[:3] == pytest.approx([2, 2, 2])
    assert "taken as grey" in told(found)


def test_old_elements_outside_the_format_are_left_out_and_said(load):
    found = load(OLD % "path" + "<mode/><hide><shape type='sphere'/></hide><!-- a comment -->" + CAMERA % FILM + LIGHT + BALL % "")
    assert len(found.shapes) == 1
    for name in ("mode", "hide"):
        assert "<%s> left out" % name in told(found)


def test_old_media_keep_their_coefficients(load):
    medium = '<medium type="homogeneous" name="interior"><rgb name="sigmaA" value="1, 2, 3"/><spectrum name="sigmaS" value="3"/>' \
        '<float name="densityMultiplier" value="2"/></medium>'
    found = load(OLD % "volpath_simple" + CAMERA % FILM + LIGHT + BALL % ('<bsdf type="null"/>' + medium))
    values = mi.traverse(found.scene.shapes()[0].interior_medium())
    assert float(values["scale"]) * np.array(values["sigma_t.value.value"]).ravel() == pytest.approx([8, 10, 12])
    assert np.array(values["albedo.value.value"]).ravel() == pytest.approx([3 / 4, 3 / 5, 3 / 6], abs=1e-6)
    assert "taken as volpath" in told(found)


def test_old_volumes_lie_where_their_file_says_and_their_shape_is_open(load, tmp_path):
    grid = mi.VolumeGrid(np.linspace(0, 1, 8, dtype="f4").reshape(2, 2, 2))
    grid.write(str(tmp_path / "v.vol"))
    volume = '<medium type="heterogeneous" %s><string name="method" value="woodcock"/><float name="stepSize" value="0.1"/>' \
        '<volume name="density" type="gridvolume"><string name="filename" value="v.vol"/></volume><float name="scale" value="3"/></medium>'
    found = load(volume % 'id="smoke"' + OLD % "volpath" + CAMERA % FILM + LIGHT + BALL % '<ref name="interior" id="smoke"/>' +
                 BALL.replace("ball", "second") % (volume % 'name="interior"') +
                 BALL.replace("ball", "glass") % '<ref name="interior" id="smoke"/><bsdf type="dielectric"/>')
    names = {shape.id(): shape.bsdf().class_name() for shape in found.scene.shapes()}
    assert names == {"ball": "Null", "second": "Null", "glass": "SmoothDielectric"}
    assert "density taken as sigma_t" in told(found) and "taken as open" in told(found) and "lost" not in told(found)
    assert float(mi.traverse(found.scene.shapes()[0].interior_medium())["scale"]) == 3


@pytest.mark.parametrize("inside, words", [
    ('<subsurface type="dipole"/>', "<subsurface type=dipole>"),
    ('<medium type="homogeneous" name="interior"><string name="material" value="skin1"/></medium>', "preset medium skin1")])
def test_what_old_media_lose_is_refused_unless_allowed(load, inside, words):
    body = OLD % "path" + CAMERA % FILM + LIGHT + BALL % inside
    code, text = refusal(load, body)
    assert code == 1 and words in text
    assert words in told(load(body, allow_losses=True))


def test_old_skies_have_y_for_up(load):
    """The sun of a direction with y above the horizon shines; in Mitsuba 3 as it stands it would be below."""
    body = OLD % "path" + CAMERA % FILM + BALL % "" + '<emitter type="%s"><vector name="sunDirection" x="0" y="1" z="-0.2"/></emitter>'
    for plugin in ("sunsky", "sky"):
        found = load(body % plugin)
        assert "y is up" in told(found) and "below the horizon" not in told(found)
        up, down = (mi.SurfaceInteraction3f(), mi.SurfaceInteraction3f())
        up.wi, down.wi = mi.Vector3f(0, -0.9, 0.436), mi.Vector3f(0, 0.9, 0.436)     # looking against wi
        light = found.scene.environment()
        assert max(light.eval(up)) > 0 and max(light.eval(down)) == 0


def test_old_textures_and_nearest_plugins(load, tmp_path):
    mi.Bitmap(np.full((2, 2, 3), 128, np.uint8)).write(str(tmp_path / "t.png"))
    texture = '<texture type="bitmap" name="%s"><string name="filename" value="t.png"/><string name="filterType" value="ewa"/>' \
        '<float name="gamma" value="1"/></texture>'
    found = load(OLD % "path" + CAMERA % FILM.replace("hdrfilm", "ldrfilm") + LIGHT + BALL % (
        '<bsdf type="roughdiffuse">%s</bsdf>' % texture % "reflectance") + BALL.replace("ball", "coated") % (
        '<bsdf type="coating"><bsdf type="roughplastic"><string name="distribution" value="phong"/></bsdf></bsdf>'))
    for words in ("roughdiffuse taken as diffuse", "filter ewa taken as bilinear", "gamma 1 taken as raw", "the coat is dropped",
                  "distribution phong taken as beckmann"):
        assert words in told(found)
    place = mi.SurfaceInteraction3f()
    place.uv = mi.Point2f(0.5, 0.5)
    assert list(found.scene.shapes()[0].bsdf().eval_diffuse_reflectance(place)) == pytest.approx([128 / 255] * 3, abs=1e-3)


def test_old_includes_are_rewritten_too(load, tmp_path):
    (tmp_path / "part.xml").write_text('<scene version="0.6.0"><bsdf type="diffuse" id="m"><srgb name="reflectance" value="#ffffff"/>'
                                       "</bsdf></scene>")
    body = OLD % "path" + '<include filename="part.xml"/>' + CAMERA % FILM + LIGHT + BALL % '<ref id="m"/>'
    first = load(body)
    assert "<srgb> made linear" in told(first)
    (tmp_path / "part.xml").write_text('<scene version="0.6.0"><include filename="part.xml"/></scene>')
    assert "includes itself" in refusal(load, body)[1]


RED = "400:0.04, %s" % ", ".join("%d:%s" % (404 + 4 * i, value) for i, value in enumerate(
    ".046 .048 .053 .049 .05 .053 .055 .057 .056 .059 .057 .061 .061 .06 .062 .062 .062 .061 .062 .06 .059 .057 .058 .058 .058 .056 .055 "
    ".056 .059 .057 .055 .059 .059 .058 .059 .061 .061 .063 .063 .067 .068 .072 .08 .09 .099 .124 .154 .192 .255 .287 .349 .402 .443 .487 "
    ".513 .558 .584 .62 .606 .609 .651 .612 .61 .65 .638 .627 .62 .63 .628 .642 .639 .657 .639 .635 .642".split()))


def reflectances(load, colours, before=""):
    body = before + OLD % "path" + CAMERA % FILM + LIGHT + "".join(
        '<shape type="sphere"><bsdf type="diffuse">%s</bsdf></shape>' % colour for colour in colours)
    found = load(body)
    return found, [np.array(mi.traverse(shape.bsdf())["reflectance.value"]).ravel() for shape in found.scene.shapes()]


def test_old_spectra_are_the_colours_that_they_were(load):
    """The red wall of the Cornell box as it was measured; Mitsuba 3 holds the colour that 0.6 made of it."""
    three, six = '<spectrum name="reflectance" value="0.8 0.6,0.9"/>', '<spectrum name="reflectance" value="%s" intent="reflectance"/>'
    white = '<spectrum name="reflectance" value="300:%s, 900:%s"/>'
    found, values = reflectances(load, [three, six % RED, white % (0.5, 0.5), white % (2, 2), six % "400:0.5, 700:0.5",
                                        six % "100:0, 400:0.5, 700:0.5, 1000:0"])
    assert values[0] == pytest.approx([0.8, 0.6, 0.9])
    assert values[1] == pytest.approx(mi.cornell_box()["red"]["reflectance"]["value"], abs=3e-4)
    equal_energy = np.array([1.204794, 0.948393, 0.908916])        # the rows of the matrix XYZ to RGB, summed
    assert values[2] == pytest.approx(equal_energy / 2, abs=3e-4)
    assert values[3] == pytest.approx(equal_energy / equal_energy[0] * 0.99, abs=3e-4)
    assert values[4] == pytest.approx(values[5], abs=1e-6)         # zero beyond the ends, as far away as the values are apart
    for words in ("three numbers taken as linear <rgb>", "measured <spectrum> made the linear <rgb>", "reflectance above 1 scaled to 0.99"):
        assert words in told(found)


def test_old_spectra_of_three_numbers_in_emitters_and_media(load):
    medium = '<medium type="homogeneous" name="interior"><spectrum name="sigmaT" value="0.5, 1, 4"/><spectrum name="albedo" ' \
        'value="0.9 0.9 0.8"/></medium>'
    lamp = '<emitter type="point"><spectrum name="intensity" value="1, 2, 3"/></emitter>'
    found = load(OLD % "volpath" + CAMERA % FILM + lamp + BALL % medium)
    values = mi.traverse(found.scene.shapes()[0].interior_medium())
    assert float(values["scale"]) * np.array(values["sigma_t.value.value"]).ravel() == pytest.approx([0.5, 1, 4])
    assert np.array(values["albedo.value.value"]).ravel() == pytest.approx([0.9, 0.9, 0.8])
    assert np.array(mi.traverse(found.scene.emitters()[0])["intensity.value"]).ravel() == pytest.approx([1, 2, 3])


def test_spectra_of_a_file_are_said_to_be_other_colours(load, tmp_path):
    (tmp_path / "red.spd").write_text("400 0.5\n700 0.5\n")
    found, _ = reflectances(load, ['<spectrum name="reflectance" filename="red.spd"/>'])
    assert "<spectrum> of the file red.spd made a colour by the rule of Mitsuba 3" in told(found)


@pytest.mark.parametrize("scales, u, v", [('<float name="uvscale" value="3"/>', 3, 3), ('<float name="uscale" value="3"/>', 3, 1),
                                          ('<float name="vscale" value="2"/><float name="uvscale" value="3"/>', 3, 2)])
def test_old_scales_of_textures_hold_for_both_axes_unless_one_is_given(load, scales, u, v):
    board = '<texture type="checkerboard" name="reflectance"><rgb name="color0" value="0"/><rgb name="color1" value="1"/>%s</texture>'
    found = load(OLD % "path" + CAMERA % FILM + LIGHT + BALL % ('<bsdf type="diffuse">%s</bsdf>' % board % scales))
    assert "lost" not in told(found)
    matrix = np.array(mi.traverse(found.scene.shapes()[0].bsdf())["reflectance.to_uv"].matrix).reshape(3, 3)
    assert [matrix[0, 0], matrix[1, 1]] == pytest.approx([u, v])

"""Scenes of rare sensors, integrators and lengths of paths: every number is that of the picture, or one line says why there is none."""
import numpy as np
import pytest

pytest.importorskip("mitsuba", reason="MITSUBA IS NOT INSTALLED: its recorder is NOT tested")

import spool
from dumps.mitsuba.reference import add_chunk, empty_reference, pixels_of
from conftest import check_ok, record

VARIANTS = pytest.mark.parametrize("variant", ["llvm_ad_rgb", "scalar_rgb"])
SCENE = """
def scene(mi):
    def at(origin, target):
        return mi.ScalarTransform4f().look_at(origin=origin, target=target, up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": 12, "height": 8}
    camera = {"type": "perspective", "fov": 40, "to_world": at([0, 0, -4], [0, 0, 0]), "film": film}
    meter = {"type": "irradiancemeter", "film": film}
    lamp = {"type": "sphere", "emitter": {"type": "area"}}
    wall = {"type": "rectangle", "to_world": at([0, 0, 4], [0, 0, 0]) @ mi.ScalarTransform4f().scale(9)}
    return {"type": "scene", %s}
"""
PATH = '"integrator": {"type": "path"}, '


@pytest.fixture
def recorded(tmp_path):
    """recorded(parts of the dict, options) -> what the command printed; the recording is tmp_path / "out.spool"."""
    def run(parts, *options):
        (tmp_path / "scene.py").write_text(SCENE % parts)
        return record(tmp_path / "scene.py", "-o", tmp_path / "out.spool", "--no-verify", "--force", "--samples", 4, *options)
    return run


@pytest.mark.parametrize("longest", [0, 1, 2])
def test_direct_light_is_no_more_than_all_light(recorded, tmp_path, longest):
    parts = '"sensor": camera, "lamp": lamp, "wall": wall, "sky": {"type": "constant"}'
    for integrator, options in (('"integrator": {"type": "path", "max_depth": %d}, ' % longest, ()), ("", ("--max-depth", longest))):
        check_ok(recorded(integrator + parts, "--channels", "direct", *options))
        with spool.open(tmp_path / "out.spool") as dump:
            radiance = dump.read("radiance")
            assert (radiance == dump.read("direct")).all() and (radiance.max() > 0) == (longest > 0)


@pytest.mark.parametrize("sensor", ['{"type": "radiancemeter", "to_world": at([0, 0, -4], [0, 0, 0]), "film": {**film, "width": 1, "height": 1}}',
                                    '{"type": "distant", "direction": [0, 0, 1], "target": [2, 0, 0], "film": {**film, "width": 1, "height": 1}}'])
def test_a_ray_that_is_the_same_in_every_sample(recorded, tmp_path, sensor):
    check_ok(recorded(PATH + '"lamp": lamp, "wall": wall, "sensor": ' + sensor, "--channels", "all", "--size", "1"))
    with spool.open(tmp_path / "out.spool") as dump:
        position = dump.read("position")
        assert position.shape == (1, 1, 4, 3) and (position == position[0, 0, 0]).all() and np.abs(position).max() > 0.9
        assert len(np.unique(dump.read("film")[..., 0])) == 4


def test_a_pixel_without_a_finite_sample_has_no_reference():
    samples = np.random.default_rng(1).random((2, 3, 8, 3)).astype("f4")
    samples[0, 1], samples[1, 2, :7, 1] = np.nan, np.inf
    mean, variance = pixels_of(add_chunk(empty_reference(2, 3), samples, 1.0))
    assert np.isnan(mean[0, 1]).all() and np.isnan(variance[0, 1]).all()
    assert np.isfinite(mean).all(axis=2).sum() == np.isfinite(variance).all(axis=2).sum() == 5
    assert mean[1, 2] == pytest.approx(samples[1, 2, 7])


@VARIANTS
def test_a_light_meter_on_a_shape_before_the_camera_is_not_recorded(recorded, tmp_path, variant):
    lamp = '"lamp": {**lamp%s}, '
    options = ("--channels", "all", "--variant", variant)
    check_ok(recorded(PATH + lamp % "" + '"sensor": camera', *options))
    with spool.open(tmp_path / "out.spool") as dump:
        plain = dump.read("radiance")
    check_ok(recorded(PATH + lamp % ', "meter": {**meter, "film": {**film, "width": 2, "height": 2}}' + '"sensor": camera', *options))
    with spool.open(tmp_path / "out.spool") as dump:
        assert (dump.read("radiance") == plain).all() and "lens" not in dump.layers and "changes" in dump.meta["scene"]
        assert dump.meta["scene"]["changes"] == []


OWN = """
def scene(mi):
    class Stripes(mi.Texture):
        def __init__(self, props):
            mi.Texture.__init__(self, props)
            self.level = props["level"]

        def eval(self, si, active=True):
            return mi.Color3f(self.level)

        def mean(self):
            return mi.Float(self.level)

    class Flat(mi.SamplingIntegrator):
        def sample(self, scene, sampler, ray, medium=None, active=True):
            return mi.Color3f(0.25), True, []

        def class_name(self):
            return "Flat"

        def to_string(self):
            return "Flat"

    mi.register_texture("stripes", Stripes)
    mi.register_integrator("flat", Flat)
    film = {"type": "hdrfilm", "width": 6, "height": 4}
    parts = {"type": "scene", "sensor": {"type": "perspective", "film": film}, "sky": {"type": "constant"}, "wall": {"type": "sphere",
             "radius": 9, "material": {"type": "twosided", "one": {"type": "diffuse", "reflectance": {"type": "stripes", "level": 0.75}}}}}
    return {**parts, "integrator": {"type": "%s"}}
"""


@VARIANTS
@pytest.mark.parametrize("integrator", ["path", "flat"])
def test_plugins_that_the_script_registers_are_used(tmp_path, variant, integrator):
    (tmp_path / "own.py").write_text(OWN % integrator)
    done = check_ok(record(tmp_path / "own.py", "-o", tmp_path / "own.spool", "--no-verify", "--samples", 4, "--variant", variant))
    assert "integrator" not in done.stderr
    with spool.open(tmp_path / "own.spool") as dump:
        assert (dump.read("albedo") == 0.75).all()
        assert (dump.read("radiance") == (0.25 if integrator == "flat" else 0)).all()


@VARIANTS
@pytest.mark.parametrize("integrator", ["%s", '{"type": "aov", "aovs": "d:depth", "inner": %s}'])
def test_features_are_of_what_stands_behind_hidden_lamps(recorded, tmp_path, variant, integrator):
    path = '{"type": "path", "hide_emitters": %s}'
    lamps = '"sensor": camera, "wall": wall, "lamp": lamp, "sky": {"type": "constant"}, '
    for hidden in (True, False):
        check_ok(recorded(lamps + '"integrator": ' + integrator % (path % hidden), "--channels", "all", "--variant", variant))
        with spool.open(tmp_path / "out.spool") as dump:
            name = dump.meta["scene"]["shapes"].index
            seen = {1 + name("wall")} if hidden else {1 + name("wall"), 1 + name("lamp")}
            shape, depth = dump.read("shape")[..., 0], dump.read("depth")[..., 0]
            assert set(np.unique(shape)) == seen and depth[shape == 1 + name("wall")] == pytest.approx(8, abs=1e-4)
            assert dump.read("normal")[shape == 1 + name("wall"), 2] == pytest.approx(-1, abs=1e-3)


@pytest.mark.parametrize("parts, code, words", [
    (PATH + '"lamp": {**lamp, "meter": meter}', 1, "no sensor: add a camera"),
    (PATH + '"lamp": lamp, "sensor": {"type": "batch", "one": camera, "film": film}', 1, "sensor batch puts the pictures of several cameras into one"),
    ('"lamp": lamp, "sensor": camera, "integrator": mi.load_dict({"type": "direct"})', 1, "integrator is an object of Mitsuba already"),
    (PATH + '"lamp": lamp, "sensor": mi.load_dict(camera)', 1, "sensor is an object of Mitsuba already: give its dict"),
    (PATH + '"lamp": lamp, "sensor": {**camera, "film": mi.load_dict(film)}', 1, "film is an object of Mitsuba already"),
    (PATH + '"lamp": lamp, "sensor": camera, "bumps": {"type": "rectangle", "material": {"type": "bumpmap", "map": {"type": "checkerboard"}, '
            '"inner": {"type": "diffuse"}}}', 3, "Mitsuba cannot render it ([Texture]"),
])
def test_what_cannot_be_recorded_is_one_line(recorded, parts, code, words):
    result = recorded(parts)
    assert result.returncode == code and words in result.stderr and result.stderr.count("\n") == 1, result.stderr

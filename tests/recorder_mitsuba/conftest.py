import os
import subprocess
import sys

import pytest

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
RECORD = os.path.join(ROOT, "dumps", "mitsuba", "record.py")
CAMERA = """<sensor type="perspective"><float name="fov" value="40"/><transform name="toWorld">
<lookAt origin="0,0,-4" target="0,0,0" up="0,1,0"/></transform>%s</sensor>"""
FILM = '<film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/></film>'
LIGHT = '<emitter type="constant"/>'
BALL = '<shape type="sphere" id="ball">%s</shape>'
OLD = '<integrator type="%s"><integer name="maxDepth" value="6"/><boolean name="strictNormals" value="true"/></integrator>'


def record(*arguments, **more):
    return subprocess.run([sys.executable, RECORD, *map(str, arguments)], capture_output=True, text=True, **more)


def check_ok(result):
    assert result.returncode == 0, result.stderr
    return result


@pytest.fixture
def load(tmp_path):
    """load(body, version, **wishes) -> Recordable"""
    mi = pytest.importorskip("mitsuba", reason="MITSUBA IS NOT INSTALLED: its recorder is NOT tested")
    before = mi.variant()
    mi.set_variant("scalar_rgb")
    from dumps.mitsuba.scene import Wishes, load_scene

    def loaded(body, version="0.6.0", **wishes):
        body = body.replace("lookAt", "lookat").replace("toWorld", "to_world") if version >= "2" else body
        (tmp_path / "scene.xml").write_text('<scene version="%s">%s</scene>' % (version, body))
        return load_scene(mi, str(tmp_path / "scene.xml"), Wishes(**wishes))

    yield loaded
    if before:
        mi.set_variant(before)


def refusal(call, *arguments, **more):
    """(exit code, its one line)"""
    from dumps.recording.failure import Failure
    with pytest.raises(Failure) as caught:
        call(*arguments, **more)
    assert "\n" not in str(caught.value)
    return caught.value.code, str(caught.value)


def told(found):
    return " | ".join(found.changes)

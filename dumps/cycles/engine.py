"""One render call -> the values of its passes.

The way without a file wraps `render` of the Cycles engine class and reads the result while the
engine still holds it (a render result is not reachable from Python in background mode). Where that
fails, a float32 EXR is written and read back; both give the same bits.
"""
import os
from array import array

import bpy

from dumps.cycles.exr import read_exr
from dumps.recording.failure import io_failure

WAYS = ("auto", "engine", "file")


class Renderer:
    """way: `engine`, `file`, or `auto` (engine, and file from the first failure on)."""

    def __init__(self, scene, way, scratch):
        self.scene, self.way, self.scratch = scene, way, scratch
        self.why_file = None
        self.caught = None
        self.engine = next((c for c in bpy.types.RenderEngine.__subclasses__()
                            if getattr(c, "bl_idname", "") == "CYCLES"), None)
        if self.engine is None:
            raise io_failure("this Blender has no Cycles")
        if way != "file":
            self._wrap()

    def render(self):
        """{render pass: (flat float32 array, components)}, bottom row first."""
        if self.way != "file":
            self.caught = None
            _render_call(False)
            if self.caught is not None and not isinstance(self.caught, Exception):
                return self.caught
            self.why_file = str(self.caught or "the engine was not called")
            if self.way == "engine":
                raise io_failure("no pixels from the engine: %s; use --pixels file" % self.why_file)
            self.way = "file"
        return self._render_to_file()

    def _wrap(self):
        original = self.engine.render
        renderer = self

        def render(engine, depsgraph):
            original(engine, depsgraph)
            try:
                renderer.caught = _read_result(engine.get_result())
            except Exception as error:     # must not leave the engine's call: Blender would go on
                renderer.caught = error

        self.engine.render = render

    def _render_to_file(self):
        render = self.scene.render
        image = render.image_settings
        if hasattr(image, "media_type"):               # 5.0
            image.media_type = "MULTI_LAYER_IMAGE"
        image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR_MULTILAYER", "32", "NONE"
        if hasattr(image, "use_exr_interleave"):       # 5.0 writes many parts without it
            image.use_exr_interleave = True
        render.use_file_extension = False
        render.filepath = os.path.join(self.scratch, "render.exr.partial")
        _render_call(True)
        try:
            return read_exr(render.filepath)
        except OSError as error:
            raise io_failure("%s: Blender wrote no image: %s" % (render.filepath, error.strerror))
        finally:
            if os.path.exists(render.filepath):
                os.remove(render.filepath)


def _render_call(write):
    try:
        state = bpy.ops.render.render(write_still=write)
    except RuntimeError as error:
        raise io_failure("Blender could not render: %s" % " ".join(str(error).split()))
    if "FINISHED" not in state:
        raise io_failure("Blender stopped the render: %s" % ", ".join(state))


def _read_result(result):
    if len(result.layers) != 1:
        raise RuntimeError("%d layers instead of one" % len(result.layers))
    count = result.resolution_x * result.resolution_y
    return {p.name: (_read_pass(p, count), p.channels) for p in result.layers[0].passes}


def _read_pass(render_pass, count):
    components = render_pass.channels
    flat = array("f", bytes(4 * count * components))
    try:
        render_pass.rect.foreach_get(flat)             # flat since 4.0
        return flat
    except TypeError:
        import numpy  # 3.x takes [pixel][component] only
        pixels = numpy.empty((count, components), numpy.float32)
        render_pass.rect.foreach_get(pixels)
        return array("f", pixels.tobytes())

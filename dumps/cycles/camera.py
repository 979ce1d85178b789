"""Film position by camera shift (mode `shift`).

Cycles shoots sample index 0 through the centre of the pixel. Moving the frame by a fraction of a
pixel (lens shift) therefore puts the sample of every pixel of a pass at one known position.
"""
from dumps.cycles.animation import curves_of
from dumps.recording.failure import scene_failure

# Cycles looks the pixel filter up in a table of 1024 entries whose last one is not used: the centre
# of the box comes out at 0.5 * 1023 / 1022 (measured and in its source, 3.0 to 5.1). Taken off here.
CENTRE = 0.5 * 1023 / 1022


class ShiftedCamera:
    """The scene's camera with its own shift remembered; `place` and `restore` move the frame."""

    def __init__(self, scene):
        self.data = scene.camera.data
        self.base = (self.data.shift_x, self.data.shift_y)
        self.pixels = shift_unit(scene)

    def refuse_unusable(self):
        if self.data.type == "PANO":
            raise scene_failure("camera '%s' is panoramic: lens shift has no effect on it, use "
                                "--mode iid" % self.data.name)
        for curve in curves_of(self.data):
            if curve.data_path in ("shift_x", "shift_y"):
                raise scene_failure("camera '%s': %s is animated and would undo the film position, use --mode iid" %
                                    (self.data.name, curve.data_path))

    def place(self, x, y):
        """Film position in the pixel, [0, 1)^2, y down (Blender's shift counts y up)."""
        self.data.shift_x = self.base[0] + (x - CENTRE) / self.pixels[0]
        self.data.shift_y = self.base[1] + ((1.0 - y) - CENTRE) / self.pixels[1]

    def restore(self):
        self.data.shift_x, self.data.shift_y = self.base


def shift_unit(scene):
    """Pixels (x, y) that the frame moves for a shift of 1: the side the sensor is fitted to."""
    render, camera = scene.render, scene.camera.data
    width, height = render.resolution_x, render.resolution_y
    wide, high = width * render.pixel_aspect_x, height * render.pixel_aspect_y
    horizontal = camera.sensor_fit == "HORIZONTAL" or (camera.sensor_fit == "AUTO" and wide >= high)
    side = wide if horizontal else high
    return side / render.pixel_aspect_x, side / render.pixel_aspect_y

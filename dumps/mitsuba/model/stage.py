"""Empty scene, sky and camera."""
import math

import numpy as np

scene, folder = {}, None
SKY_ROWS = 1024


def open_folder(path):
    global folder
    folder = path
    scene.clear()
    scene.update(type="scene", integrator={"type": "path", "max_depth": 13})   # Cycles: 12 bounces


def start_scene(bottom, top, strength):
    """Sky from `bottom` (0.2 below the horizon) to `top` (0.8 above it); up is z."""
    import mitsuba as mi
    height = np.cos((np.arange(SKY_ROWS) + 0.5) / SKY_ROWS * math.pi)
    share = np.clip((height + 0.2) / 1.0, 0, 1)[:, None]
    rows = strength * ((1 - share) * np.array(bottom) + share * np.array(top))
    scene["sky"] = {"type": "envmap", "bitmap": mi.Bitmap(np.repeat(rows[:, None], 8, axis=1).astype(np.float32)),
                    "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], 90)}
    return scene


def add_camera(location, target, focal_mm, focus=None, radius=0.0):
    """Blender's: a sensor 36 mm wide along the longer side of the picture."""
    import mitsuba as mi
    camera = {"type": "thinlens" if focus else "perspective", "fov": math.degrees(2 * math.atan(18 / focal_mm)),
              "fov_axis": "larger", "film": {"type": "hdrfilm", "width": 256, "height": 256},
              "to_world": mi.ScalarTransform4f().look_at(origin=list(location), target=list(target), up=[0, 0, 1])}
    if focus:
        camera.update(focus_distance=focus, aperture_radius=radius)
    scene["camera"] = camera


def add_shape(name, shape):
    scene["%s_%d" % (name, len(scene))] = shape

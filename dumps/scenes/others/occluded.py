"""A room whose lamp hangs over a slab under the ceiling: light comes in through the gaps beside it.

Mesh and colours are those of scenes/occluded.obj and .json in wxrrr123/Lumen (MIT), whose folder `scenes` is given with
--files; the ball that is a mirror there is rough gold here.
"""
import atexit
import shutil
import tempfile
from pathlib import Path

WHITE, RED, GREEN = [0.725, 0.71, 0.68], [0.63, 0.065, 0.05], [0.14, 0.45, 0.091]


def objects(path):
    """{name: a file with this object alone}; Mitsuba makes one mesh of an .obj file."""
    folder = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    shared, faces = [], {}
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("o "):
            own = faces.setdefault(line[2:].strip(), [])
        elif line.startswith("f "):
            own.append(line)
        elif line.startswith("v"):
            shared.append(line)
    for name, lines in faces.items():
        (folder / (name + ".obj")).write_text("\n".join([*shared, *lines, ""]), encoding="utf-8")
    return {name: str(folder / (name + ".obj")) for name in faces}


def diffuse(colour):
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": colour}}}


def scene(mi):
    other = {"left_wall": diffuse(RED), "right_wall": diffuse(GREEN), "glass_sphere": {"type": "dielectric", "int_ior": 1.52},
             "mirror_sphere": {"type": "twosided", "bsdf": {"type": "roughconductor", "material": "Au", "alpha": 0.1}}}
    made = {"type": "scene", "integrator": {"type": "path", "max_depth": 16},
            "sensor": {"type": "perspective", "fov": 32, "film": {"type": "hdrfilm", "width": 512, "height": 512},
                       "to_world": mi.ScalarTransform4f().look_at([0.7, -1.5, 15.5], [0.4, -2.0, 0], [0, 1, 0])}}
    for name, path in objects(Path(str(mi.file_resolver().resolve("occluded.obj")))).items():
        made[name] = {"type": "obj", "filename": path, "material": other.get(name, diffuse(WHITE))}
    made["light"]["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": [51, 36, 12]}}
    return made

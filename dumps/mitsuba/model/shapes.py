"""Meshes with Blender's vertices and normals, as PLY files."""
import os

import numpy as np

from . import blender_shapes, stage

_outlines = blender_shapes()
turned, rounded, ball_profile = _outlines.turned, _outlines.rounded, _outlines.ball_profile
TEXELS = 125            # per unit of a sheet's texture: edges at multiples of 0.008 are exact


def add_mesh(name, vertices, faces, material, smooth=False, location=(0, 0, 0), rotation=(0, 0, 0)):
    if tuple(rotation) != (0, 0, 0):
        raise KeyError("rotation of '%s'" % name)
    points = np.array(vertices, np.float64)
    path = os.path.join(stage.folder, "%d.ply" % len(stage.scene))
    write_ply(path, points + np.array(location), normals_of(points, faces) if smooth else None, faces)
    shape = {"type": "ply", "filename": path, "face_normals": not smooth, "bsdf": material.surface()}
    if material.emission:
        shape["light"] = {"type": "area", "radiance": {"type": "rgb", "value": material.emission}}
    stage.add_shape(name.replace(" ", "_"), shape)


def add_ball(name, radius, location, material, segments=32):
    vertices, faces = turned(ball_profile(radius, segments), segments)
    add_mesh(name, vertices, faces, material, True, location)


def add_sheet(name, width, depth, location, material):
    import mitsuba as mi
    texture = None
    if material.colour_at:
        texture = {"type": "bitmap", "bitmap": mi.Bitmap(drawn(material.colour_at, width, depth)), "raw": True,
                   "filter_type": "nearest", "wrap_mode": "clamp"}
    place = mi.ScalarTransform4f().translate(list(location)).scale([width / 2, depth / 2, 1])
    stage.add_shape(name, {"type": "rectangle", "to_world": place, "bsdf": material.surface(texture)})


def drawn(colour_at, width, depth):
    """float32 [v][u][rgb], v up; one column where the colour does not depend on x."""
    y = (np.arange(round(depth * TEXELS)) + 0.5) / TEXELS - depth / 2
    x = (np.arange(round(width * TEXELS)) + 0.5) / TEXELS - width / 2

    def columns(at):
        grid = np.stack(np.broadcast_arrays(at[None, :], y[:, None], 0.0), axis=-1)
        return colour_at(grid).astype(np.float32)

    few = columns(x[:: max(1, len(x) // 16)])
    image = few[:, :1] if (few == few[:, :1]).all() else columns(x)
    return np.ascontiguousarray(image[::-1])


def normals_of(points, faces):
    """Of vertices: the faces' normals weighted with their angle there, as Blender's."""
    total = np.zeros_like(points)
    for face in faces:
        corners = points[list(face)]
        after, before = np.roll(corners, -1, axis=0) - corners, np.roll(corners, 1, axis=0) - corners
        normal = np.cross(after, before).sum(axis=0)
        cosine = (after * before).sum(axis=1) / np.linalg.norm(after, axis=1) / np.linalg.norm(before, axis=1)
        np.add.at(total, list(face), np.arccos(np.clip(cosine, -1, 1))[:, None] * normal / np.linalg.norm(normal))
    return total / np.linalg.norm(total, axis=1, keepdims=True)


def write_ply(path, points, normals, faces):
    triangles = [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
    rows = points if normals is None else np.hstack([points, normals])
    names = ["x", "y", "z", "nx", "ny", "nz"][:rows.shape[1]]
    with open(path, "w") as stream:
        stream.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(rows))
        stream.writelines("property float %s\n" % name for name in names)
        stream.write("element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(triangles))
        stream.writelines(" ".join("%.9g" % v for v in row) + "\n" for row in rows)
        stream.writelines("3 %d %d %d\n" % triangle for triangle in triangles)

"""Meshes from plain vertex and face lists, always in the same order.

The order matters: which triangle of a lamp a random number picks depends on it. Blender's own mesh
operators (bmesh.ops) change it from run to run, and with it the samples.
"""
import math

import bpy

# Blender 3 sums the normals of larger meshes (from 1024 faces) in several threads, in any order: their
# last bits, and with them the samples, would differ from one process to the next.
MOST_FACES = 1000


def add_mesh(name, vertices, faces, material, smooth=False, location=(0, 0, 0), rotation=(0, 0, 0)):
    if len(faces) > MOST_FACES:
        raise ValueError("%s: %d faces, more than %d are not reproducible" %
                         (name, len(faces), MOST_FACES))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    mesh.update()
    mesh.materials.append(material)
    return place_copy(name, mesh, location, rotation)


def place_copy(name, mesh, location=(0, 0, 0), rotation=(0, 0, 0)):
    item = bpy.data.objects.new(name, mesh)
    item.location, item.rotation_euler = location, rotation
    bpy.context.scene.collection.objects.link(item)
    return item


def turned(profile, segments):
    """Surface of revolution about z. profile: (radius, height) from bottom to top; points on the axis
    become one vertex."""
    vertices, rings = [], []
    for radius, height in profile:
        count = 1 if radius == 0 else segments
        rings.append(range(len(vertices), len(vertices) + count))
        for i in range(count):
            angle = 2 * math.pi * i / segments
            vertices.append((radius * math.cos(angle), radius * math.sin(angle), height))
    faces = []
    for low, high in zip(rings, rings[1:]):
        for i in range(segments):
            j = (i + 1) % segments
            if len(low) > 1 and len(high) > 1:
                faces.append((low[i], low[j], high[j], high[i]))
            elif len(high) > 1:
                faces.append((low[0], high[j], high[i]))
            elif len(low) > 1:
                faces.append((low[i], low[j], high[0]))
    return vertices, faces


def rounded(points, steps):
    """Points along a uniform cubic spline through `points` (Catmull-Rom), `steps` per interval."""
    padded = [points[0], *points, points[-1]]
    out = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:]):
        for i in range(steps):
            t = i / steps
            weights = ((-t + 2 * t * t - t**3) / 2, (2 - 5 * t * t + 3 * t**3) / 2,
                       (t + 4 * t * t - 3 * t**3) / 2, (t**3 - t * t) / 2)
            x, y = (sum(w * p[k] for w, p in zip(weights, (a, b, c, d))) for k in (0, 1))
            out.append((max(0.0, x), y))
    return out + [tuple(points[-1])]


def ball_profile(radius, segments):
    rings = max(2, segments // 2)
    inner = [(radius * math.sin(math.pi * i / rings), -radius * math.cos(math.pi * i / rings))
             for i in range(1, rings)]
    return [(0.0, -radius), *inner, (0.0, radius)]


def add_ball(name, radius, location, material, segments=32, rotation=(0, 0, 0)):
    vertices, faces = turned(ball_profile(radius, segments), segments)
    return add_mesh(name, vertices, faces, material, True, location, rotation)


def add_turned(name, profile, material, location=(0, 0, 0), segments=40, rotation=(0, 0, 0)):
    vertices, faces = turned(profile, segments)
    return add_mesh(name, vertices, faces, material, True, location, rotation)


def add_sheet(name, width, depth, location, material, rotation=(0, 0, 0)):
    x, y = width / 2, depth / 2
    vertices = [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)]
    return add_mesh(name, vertices, [(0, 1, 2, 3)], material, False, location, rotation)


def add_block(name, size, location, material, rotation=(0, 0, 0), chamfer=0.0):
    """A box; with `chamfer` its top edges are cut at 45 degrees."""
    x, y, z = (s / 2 for s in size)
    c = chamfer
    levels = [(x, y, -z), (x, y, z - c)] + ([(x - c, y - c, z)] if c > 0 else [])
    vertices, faces = [], []
    for wide, deep, height in levels:
        vertices += [(-wide, -deep, height), (wide, -deep, height), (wide, deep, height),
                     (-wide, deep, height)]
    for level in range(len(levels) - 1):
        for i in range(4):
            j, a = (i + 1) % 4, 4 * level
            faces.append((a + i, a + j, a + 4 + j, a + 4 + i))
    top = 4 * (len(levels) - 1)
    faces += [(3, 2, 1, 0), (top, top + 1, top + 2, top + 3)]
    return add_mesh(name, vertices, faces, material, False, location, rotation)

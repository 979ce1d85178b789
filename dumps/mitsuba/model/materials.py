"""Materials; colours that depend on the place are functions of points, drawn into a texture by the sheet."""
import numpy as np

SOCKETS = {"Metallic": "metallic", "Specular": "specular"}


class Shader:
    def __init__(self, name, colour=(0.8, 0.8, 0.8), roughness=0.5, **sockets):
        self.colour, self.roughness, self.emission, self.colour_at = colour, roughness, None, None
        self.sockets, self.material = dict(sockets), self

    def place(self):
        return lambda points: points

    def add(self, kind, inputs):
        if kind != "ShaderNodeSeparateXYZ":
            raise KeyError(kind)
        return _Axes(inputs[0])

    def math(self, operation, first, second=0.0):
        function = {"MULTIPLY": np.multiply, "ADD": np.add, "LESS_THAN": np.less, "GREATER_THAN": np.greater,
                    "FRACT": lambda a, b: a - np.floor(a)}[operation]

        def value(points):
            a, b = (item(points) if callable(item) else item for item in (first, second))
            return function(a, b).astype(np.float64)
        return value

    def blend(self, factor, stops):
        places, colours = [p for p, _ in stops], np.array([c for _, c in stops])
        return lambda points: np.stack([np.interp(factor(points), places, c) for c in colours.T], axis=-1)

    def feed(self, name, output):
        if name != "Base Color":
            raise KeyError(name)
        self.colour_at = output

    def surface(self, texture=None):
        """texture: what stands for the base colour."""
        sockets = dict(self.sockets)
        if sockets.pop("Transmission", 0.0) == 1.0 and self.roughness == 0.0:
            return {"type": "dielectric", "int_ior": sockets.pop("IOR"), "ext_ior": 1.0,
                    "specular_transmittance": {"type": "rgb", "value": list(self.colour)}}
        found = {"type": "principled", "roughness": self.roughness, "specular": 0.5,
                 "base_color": texture or {"type": "rgb", "value": list(self.colour)}}
        found.update((SOCKETS[socket], value) for socket, value in sockets.items())
        return {"type": "twosided", "inside": found}


class _Axes:
    def __init__(self, vector):
        self.outputs = {axis: lambda points, i=i: vector(points)[..., i] for i, axis in enumerate("XYZ")}


def plain(name, colour, roughness=0.5, **sockets):
    return Shader(name, colour, roughness, **sockets)


def glowing(name, colour, strength):
    material = Shader(name, (0.0, 0.0, 0.0))
    material.emission = [strength * c for c in colour]
    return material

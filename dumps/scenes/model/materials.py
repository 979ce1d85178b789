"""Materials on the Principled node, whose sockets were renamed in Blender 4.0."""
import bpy

RENAMED = {"Specular": "Specular IOR Level", "Clearcoat": "Coat Weight",
           "Transmission": "Transmission Weight", "Emission": "Emission Color"}


class Shader:
    """A material under construction: its node tree, the Principled node, and short ways to wire."""

    def __init__(self, name, colour=(0.8, 0.8, 0.8), roughness=0.5, **sockets):
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.surface = next(n for n in self.tree.nodes if n.type == "BSDF_PRINCIPLED")
        self.set("Base Color", (*colour, 1))
        self.set("Roughness", roughness)
        for socket, value in sockets.items():
            self.set(socket.replace("_", " "), value)

    def socket(self, name):
        inputs = self.surface.inputs
        return inputs[name] if name in inputs else inputs[RENAMED[name]]

    def set(self, name, value):
        self.socket(name).default_value = (*value, 1) if isinstance(value, tuple) and len(value) == 3 \
            else value

    def add(self, kind, inputs=None, **properties):
        """A node; inputs by name or place are values or output sockets of other nodes."""
        node = self.tree.nodes.new(kind)
        for key, value in properties.items():
            setattr(node, key, value)
        for key, value in (inputs or {}).items():
            self.wire(value, node.inputs[key])
        return node

    def wire(self, value, target):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, target)
        else:
            target.default_value = value

    def feed(self, name, output):
        self.tree.links.new(output, self.socket(name))

    def place(self):
        """Object coordinates."""
        return self.add("ShaderNodeTexCoord").outputs["Object"]

    def math(self, operation, first, second=0.0):
        return self.add("ShaderNodeMath", {0: first, 1: second}, operation=operation).outputs[0]

    def blend(self, factor, stops):
        """Colour by a ramp; stops: (position, colour), at least two."""
        node = self.add("ShaderNodeValToRGB", {0: factor})
        elements = node.color_ramp.elements
        for i, (position, colour) in enumerate(stops):
            element = elements[i] if i < 2 else elements.new(position)
            element.position, element.color = position, (*colour, 1)
        return node.outputs["Color"]


def plain(name, colour, roughness=0.5, **sockets):
    return Shader(name, colour, roughness, **sockets).material


def glowing(name, colour, strength):
    return Shader(name, (0, 0, 0), Emission=colour, Emission_Strength=strength).material


def grained(name, dark, light, scale, roughness=0.3, coat=0.3):
    """Wood: distorted rings between two colours."""
    shader = Shader(name, dark, roughness, Clearcoat=coat)
    wave = shader.add("ShaderNodeTexWave", {"Vector": shader.place(), "Scale": scale,
                                            "Distortion": 7.0, "Detail": 3.0},
                      wave_type="RINGS", rings_direction="Y")
    shader.feed("Base Color", shader.blend(wave.outputs["Fac"], [(0.15, dark), (0.85, light)]))
    return shader.material

"""Empty scene, lamps, sky and camera."""
import bpy
from mathutils import Vector


def start_scene(bottom, top, strength):
    """An empty scene under a sky that goes from `bottom` (below the horizon) to `top`."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    world = scene.world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = next(n for n in nodes if n.type == "BACKGROUND")
    background.inputs["Strength"].default_value = strength
    place = nodes.new("ShaderNodeTexCoord")
    axes = nodes.new("ShaderNodeSeparateXYZ")
    height = nodes.new("ShaderNodeMapRange")
    height.inputs["From Min"].default_value, height.inputs["From Max"].default_value = -0.2, 0.8
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (*bottom, 1), (*top, 1)
    links.new(place.outputs["Generated"], axes.inputs[0])
    links.new(axes.outputs["Z"], height.inputs["Value"])
    links.new(height.outputs["Result"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], background.inputs["Color"])
    return scene


def aim(item, location, target):
    item.location = location
    direction = Vector(target) - Vector(location)
    item.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()


def add_lamp(name, location, target, width, power, colour=(1, 1, 1), depth=None):
    """A square (or width x depth) area lamp that points at `target`; power in watts."""
    light = bpy.data.lights.new(name, "AREA")
    light.energy, light.color, light.size = power, colour, width
    if depth:
        light.shape, light.size_y = "RECTANGLE", depth
    item = bpy.data.objects.new(name, light)
    bpy.context.scene.collection.objects.link(item)
    aim(item, location, target)
    return item


def add_camera(location, target, focal_mm, focus=None, radius=0.0):
    """focus: the distance that is sharp, with a lens of `radius` (scene units); None: pinhole."""
    data = bpy.data.cameras.new("camera")
    data.lens = focal_mm
    item = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item
    aim(item, location, target)
    if focus:
        data.dof.use_dof, data.dof.focus_distance = True, focus
        data.dof.aperture_fstop = focal_mm / 1000 / (2 * radius)
    return item

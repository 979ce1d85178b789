"""What the panel lets one choose; kept in the .blend file with the scene."""
import bpy

# The channels of ../passes.py that one may add to the radiance, and those that need a known position.
CHANNELS = (
    ("albedo", "Albedo", "Diffuse colour of the first hit"),
    ("normal", "Normal", "Shading normal of the first hit, world space"),
    ("depth", "Depth", "Of the first hit; 0 where nothing is hit"),
    ("direct", "Direct light", "The part of the radiance that met at most one surface"),
    ("albedo_ns", "Albedo behind glass", "Of the first surface that is no mirror or glass"),
    ("normal_ns", "Normal behind glass", "Of the first surface that is no mirror or glass, camera space"),
    ("depth_ns", "Depth behind glass", "Length of the path to the first surface that is no mirror or glass"),
    ("position", "Position", "Of the first hit, world space; mode Known position only"),
    ("object", "Object", "Index of the object that was hit; mode Known position only"),
)


class Settings(bpy.types.PropertyGroup):
    file: bpy.props.StringProperty(
        name="File", subtype="FILE_PATH", default="//recording.spool",
        description="The dump to make; the passes stand in FILE.passes until it is whole")
    samples: bpy.props.IntProperty(name="Samples", default=64, min=1, max=65536, description="Per pixel")
    reference: bpy.props.IntProperty(
        name="Reference", default=4096, min=0, max=2**24,
        description="Samples per pixel of an independent reference; 0: none")
    seed: bpy.props.IntProperty(name="Seed", default=1, min=0, description="Of the recording")
    mode: bpy.props.EnumProperty(name="Mode", default="iid", items=(
        ("iid", "Independent", "A new seed for each sample"),
        ("shift", "Known position", "A new seed for each sample; all pixels share one known film position"),
        ("sequence", "Sequence", "Consecutive samples of one low-discrepancy sequence")))
    channels: bpy.props.EnumProperty(name="Channels", items=CHANNELS, options={"ENUM_FLAG"},
                                     default={"albedo", "normal", "depth"},
                                     description="Recorded beside the radiance")


def channel_list(settings):
    return ",".join(["radiance"] + [name for name, *_ in CHANNELS if name in settings.channels])

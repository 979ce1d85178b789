"""Which render passes a channel is made of, and how their values become planes.

A plane is an array of float32, row-major, top row first. Render passes arrive as flat arrays,
components interleaved, bottom row first, as the engine keeps them.
"""
import struct
from array import array
from collections import namedtuple

try:
    import numpy
except ImportError:        # Blender runs without it: the same values, ten times slower
    numpy = None

from dumps.recording.failure import io_failure, usage_failure

NOTHING = 1e9          # Cycles writes 1e10 as the depth of rays that hit nothing; a recording holds 0
LARGEST_HALF = 65504.0


# components: names after the dot. sources: the render passes wanted, by their names before 5.0.
# space: of vectors, `world` or `camera`. index_zero: Cycles writes the pass for sample index 0
# alone, so it exists in mode `shift` only. mix: {source: flat array, RGB} -> flat array.
Channel = namedtuple("Channel", "components sources note space index_zero dtype mix", defaults=(None, False, "f16", None))
LIGHT = ("Diff", "Gloss", "Trans")
BLACK = (0.0, 0.0, 0.0)


def _direct(values):
    """Light that met no surface or one: seen emitters and each closure's colour times direct light."""
    total = [e + w for e, w in zip(values["Emit"], values["Env"])]
    total = [t + v for t, v in zip(total, values["VolumeDir"])]
    for kind in LIGHT:
        total = [t + c * d for t, c, d in zip(total, values[kind + "Col"], values[kind + "Dir"])]
    return array("f", total)


def _albedo(flat):
    """Diffuse colour; where there is none, what the surface mirrors and lets through: denoisers divide by the albedo."""
    diffuse, glossy, through = (flat[kind + "Col"] for kind in LIGHT)
    if numpy:
        found, one, two = (numpy.frombuffer(v, "f4").reshape(-1, 3) for v in (array("f", diffuse), glossy, through))
        black = ~found.any(axis=1)
        found[black] = numpy.minimum(1, one[black] + two[black])
        return array("f", found.tobytes())
    found = array("f", diffuse)
    for pixel, rgb in enumerate(zip(diffuse[0::3], diffuse[1::3], diffuse[2::3])):
        if rgb == BLACK:
            for i in (3 * pixel, 3 * pixel + 1, 3 * pixel + 2):
                found[i] = min(1.0, glossy[i] + through[i])
    return found


CHANNELS = {
    "radiance": Channel("RGB", ("Combined",), "linear Rec.709, times the scene's film exposure",
                        dtype="f32"),
    "albedo": Channel("RGB", tuple(kind + "Col" for kind in LIGHT), "diffuse colour of the first hit; on metal and "
                      "glass, which have none, what they mirror and let through; 0 where nothing is hit", mix=_albedo),
    "albedo_ns": Channel("RGB", ("Denoising Albedo",), "colour of the first surface that is not a "
                         "mirror or glass; of the background where nothing is hit"),
    "normal": Channel("XYZ", ("Normal",), "shading normal of the first hit; 0 where nothing is hit",
                      space="world"),
    "normal_ns": Channel("XYZ", ("Denoising Normal",), "shading normal of the first surface that is "
                         "not a mirror or glass; 0 where nothing is hit", space="camera"),
    "depth": Channel("Z", ("Depth",), "depth of the first hit along the viewing axis; 0 where nothing "
                     "is hit", index_zero=True),
    "depth_ns": Channel("Z", ("Denoising Depth",), "length of the path, from the near clipping plane "
                        "to the first surface that is not a mirror or glass"),
    "position": Channel("XYZ", ("Position",), "first hit; 0 where nothing is hit", space="world",
                        index_zero=True, dtype="f32"),
    "object": Channel(("ID",), ("IndexOB",), "1 + index of the object among all "
                      "objects of the file by name; 0 where nothing is hit", index_zero=True,
                      dtype="f32"),
    "direct": Channel("RGB", ("Emit", "Env", "VolumeDir") + tuple(
        k + part for k in LIGHT for part in ("Col", "Dir")),
        "part of the radiance that met at most one surface; indirect = radiance - direct",
        dtype="f32", mix=_direct),
}
MIST_DEPTH = Channel("Z", ("Mist",), "distance of the first hit from the camera; 0 where nothing is "
                     "hit")
DEFAULT = ("radiance", "albedo", "normal", "depth")
# What may be asked for and Cycles does not provide: neither a pass nor a shader node holds these numbers.
NOT_TOLD = {
    "lens": "Cycles does not tell where on the lens a sample starts: record with dumps/mitsuba",
    "time": "Cycles does not tell at which moment of the shutter a sample is taken: record with dumps/mitsuba",
    "indirect": "record `direct`: indirect = radiance - direct",
}
# Blender 5.0 gave passes longer names.
RENAMED = {"IndexOB": "Object Index", "Emit": "Emission", "Env": "Environment",
           "VolumeDir": "Volume Direct", "DiffCol": "Diffuse Color", "DiffDir": "Diffuse Direct",
           "GlossCol": "Glossy Color", "GlossDir": "Glossy Direct",
           "TransCol": "Transmission Color", "TransDir": "Transmission Direct"}
# View-layer switches by render pass.
SWITCHES = {"Combined": "use_pass_combined", "Depth": "use_pass_z", "Mist": "use_pass_mist",
            "Normal": "use_pass_normal", "Position": "use_pass_position",
            "IndexOB": "use_pass_object_index", "Emit": "use_pass_emit",
            "Env": "use_pass_environment", "DiffCol": "use_pass_diffuse_color",
            "DiffDir": "use_pass_diffuse_direct", "GlossCol": "use_pass_glossy_color",
            "GlossDir": "use_pass_glossy_direct", "TransCol": "use_pass_transmission_color",
            "TransDir": "use_pass_transmission_direct"}
CYCLES_SWITCHES = {"Denoising Albedo": "denoising_store_passes",
                   "Denoising Normal": "denoising_store_passes",
                   "Denoising Depth": "denoising_store_passes",
                   "VolumeDir": "use_pass_volume_direct"}


def plan_channels(names, mode):
    """{name: Channel}, radiance first; names that this mode cannot fill are refused."""
    names = [n for n in names if not (n == "film" and mode == "shift")]    # always recorded there
    unknown = [n for n in names if n not in CHANNELS]
    if unknown and unknown[0] in NOT_TOLD:
        raise usage_failure("channel '%s': %s" % (unknown[0], NOT_TOLD[unknown[0]]))
    if unknown and unknown[0] == "film":
        raise usage_failure("channel 'film': Cycles gives no film position in mode %s: use --mode shift" % mode)
    if unknown:
        raise usage_failure("channel '%s' is unknown: use %s" % (unknown[0], ", ".join(CHANNELS)))
    plan = {"radiance": CHANNELS["radiance"]}
    for name in names:
        channel = CHANNELS[name]
        if channel.index_zero and mode != "shift":
            if name != "depth":
                raise usage_failure("channel '%s' exists for sample index 0 alone: use --mode shift"
                                    % name)
            channel = MIST_DEPTH
        plan[name] = channel
    return plan


def channel_names(plan):
    return ["%s.%s" % (name, c) for name, channel in plan.items() for c in channel.components]


def describe_channels(plan):
    """The list `channels` of the manifest, in the order of the planes of a pass file."""
    return [{"name": "%s.%s" % (name, c), "dtype": channel.dtype}
            for name, channel in plan.items() for c in channel.components]


def describe_layers(plan):
    """What the numbers of each layer are, for `meta.channels` of the recording."""
    return {name: dict({"space": channel.space} if channel.space else {}, note=channel.note)
            for name, channel in plan.items()}


def switch_passes(view_layer, plan):
    """Turns on what the plan needs and turns off what it does not: every pass costs time."""
    wanted = {source for channel in plan.values() for source in channel.sources}
    for name, switch in SWITCHES.items():
        setattr(view_layer, switch, name in wanted or name == "Combined")
    cycles = view_layer.cycles
    for switch in sorted(set(CYCLES_SWITCHES.values())):
        setattr(cycles, switch, any(n in wanted for n, s in CYCLES_SWITCHES.items() if s == switch))


def planes_of(plan, rendered, width, height, mist_depth):
    """rendered: {render pass: (flat array, components)}. Returns the bytes of a pass file,
    float32 [channel][y][x]."""
    out = []
    for name, channel in plan.items():
        found = [_find(rendered, source) for source in channel.sources]
        flat, n = found[0]
        if channel.mix:
            flat = channel.mix({source: values for source, (values, _) in zip(channel.sources, found)})
        for c in range(len(channel.components)):
            plane = flat[c::n]
            if channel.sources == MIST_DEPTH.sources:
                plane = array("f", [0.0 if v >= 1.0 else v * mist_depth for v in plane])
            elif name == "depth":
                plane = array("f", [0.0 if v > NOTHING else v for v in plane])
            if len(plane) != width * height:
                raise io_failure("channel '%s' came with %d values instead of %d" %
                                 (name, len(plane), width * height))
            out.append(flip_rows(to_half(plane) if channel.dtype == "f16" else plane, width, height))
    return b"".join(out)


def to_half(plane):
    """Rounded as the recording will be, so that a packed pass is hardly larger; as it is where a value is too large for that."""
    if numpy:
        values = numpy.frombuffer(plane, "f4")
        if (numpy.abs(values[numpy.isfinite(values)]) > LARGEST_HALF).any():
            return plane
        return array("f", values.astype("f2").astype("f4").tobytes())
    try:
        return array("f", struct.unpack("%de" % len(plane), struct.pack("%de" % len(plane), *plane)))
    except OverflowError:
        return plane


def _find(rendered, source):
    for name in (source, RENAMED.get(source)):
        if name in rendered:
            return rendered[name]
    raise io_failure("the renderer gave no pass '%s' (it gave %s)" %
                     (source, ", ".join(sorted(rendered))))


def flip_rows(plane, width, height):
    raw = memoryview(plane).cast("B")
    row = 4 * width
    return b"".join(raw[y * row:(y + 1) * row] for y in reversed(range(height)))

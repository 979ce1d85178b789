"""Channels (what CHAN lists) and layers (the channels that share a name before the dot)."""
import re
from collections import namedtuple

import numpy as np

from . import record_layout as layout
from .arguments import mapping, texts, wrong
from .error import SpoolError

# dtype is a numpy dtype; scope is "sample", "pixel" or "pass".
Channel = namedtuple("Channel", "name group dtype semantic scope", defaults=(0, "sample"))
# components: the channel suffixes in file order; first: where they start on the channel axis of their group.
Layer = namedtuple("Layer", "name group dtype scope components first")

_NAME = re.compile(rb"[a-z][a-z0-9_]*\.[A-Za-z][A-Za-z0-9]*")

# Layer -> (components, semantic), section 10 of the specification.
VOCABULARY = {
    "radiance": ("RGB", 1), "diffuse": ("RGB", 1), "direct": ("RGB", 1), "film": ("XY", 6), "lens": ("UV", 6),
    "time": ("T", 6), "normal": ("XYZ", 3), "normal_ns": ("XYZ", 3), "normal_geo": ("XYZ", 3), "albedo": ("RGB", 2),
    "albedo_ns": ("RGB", 2), "depth": ("Z", 5), "depth_ns": ("Z", 5), "position": ("XYZ", 4),
    "position_ns": ("XYZ", 4), "motion": ("XYZ", 4), "visibility": ("V", 8), "hit": ("H", 8), "path": (("flags",), 9),
    "seed": ("S", 9), "reference": ("RGB", 1), "reference_variance": ("RGB", 7), "sample_variance": ("RGB", 7)}


def encode(channels):
    """CHAN payload of a list of Channel."""
    table = np.zeros(len(channels), layout.CHAN)
    numbers = {dtype: number for number, dtype in layout.DTYPES.items()}
    for row, channel in zip(table, channels):
        row["name"] = np.void(channel.name.encode("ascii").ljust(32, b"\0"))
        row["group"], row["semantic"] = channel.group, channel.semantic
        row["dtype"] = numbers[np.dtype(channel.dtype)]
        row["scope"] = layout.SCOPES.index(channel.scope)
    return table.tobytes()


def decode(payload, group_count, newer_minor):
    """CHAN payload -> list of Channel; SpoolError says which entry breaks which rule."""
    channels = []
    for number, row in enumerate(np.frombuffer(payload, layout.CHAN)):
        raw = row["name"].tobytes()
        name = raw.rstrip(b"\0")
        if len(name) > 31 or raw != name.ljust(32, b"\0") or not _NAME.fullmatch(name):
            raise _invalid(f"name {name!r} is not layer.component (channel {number})")
        if row["reserved"].tobytes().strip(b"\0") and not newer_minor:
            raise _invalid(f"reserved bytes are not zero (channel {number})")
        semantic = int(row["semantic"])
        if semantic > layout.MAX_SEMANTIC:
            if not newer_minor:
                raise _invalid(f"semantic {semantic} is not defined (channel {number})")
            semantic = 0
        if int(row["dtype"]) not in layout.DTYPES:
            raise _invalid(f"dtype {row['dtype']} is not defined (channel {number})")
        if int(row["scope"]) >= len(layout.SCOPES):
            raise _invalid(f"scope {row['scope']} is not defined (channel {number})")
        channels.append(Channel(name.decode("ascii"), int(row["group"]), layout.DTYPES[int(row["dtype"])], semantic,
                                layout.SCOPES[int(row["scope"])]))
    validate(channels, group_count)
    return channels


def validate(channels, group_count):
    """The rules of section 4.2, for reader and writer alike."""
    seen = {}
    previous = None
    for number, channel in enumerate(channels):
        if not _NAME.fullmatch(channel.name.encode("utf-8")) or len(channel.name) > 31:
            raise _invalid(f"name {channel.name!r} is not layer.component (channel {number})")
        if channel.name in seen:
            raise _invalid(f"name {channel.name} occurs twice (channel {number})")
        seen[channel.name] = number
        expected = (0,) if previous is None else (previous.group, previous.group + 1)
        if channel.group not in expected or channel.group >= group_count:
            raise _invalid(f"group {channel.group} is out of order (channel {number})")
        if previous is not None and channel.group == previous.group and (
                np.dtype(channel.dtype), channel.scope) != (np.dtype(previous.dtype), previous.scope):
            raise _invalid(f"dtype or scope differs inside group {channel.group} (channel {number})")
        previous = channel
    if previous is None or previous.group != group_count - 1:
        raise _invalid(f"not every group from 0 to {group_count - 1} has channels (CHAN)")
    for name, members in _members(channels).items():
        numbers = [seen[channel.name] for channel in members]
        if numbers[-1] - numbers[0] != len(numbers) - 1 or len({channel.group for channel in members}) != 1:
            raise _invalid(f"channels of layer {name} are not neighbours of one group (CHAN)")
    radiance = [channel for channel in channels if channel.group == 0]
    if ([channel.name for channel in radiance] != ["radiance.R", "radiance.G", "radiance.B"]
            or radiance[0].scope != "sample" or np.dtype(radiance[0].dtype).kind != "f"):
        raise _invalid("group 0 is not radiance.R, .G, .B of scope sample in f16 or f32 (CHAN)")


def layers_of(channels):
    """{layer name: Layer}, in file order."""
    result, first, group = {}, 0, 0
    for name, members in _members(channels).items():
        if members[0].group != group:
            first, group = 0, members[0].group
        result[name] = Layer(name, group, members[0].dtype, members[0].scope,
                             tuple(channel.name.partition(".")[2] for channel in members), first)
        first += len(members)
    return result


def channels_of(layers):
    """{layer: (dtype, components[, scope])} -> list of Channel, each layer a group of its own."""
    channels = []
    for group, (name, description) in enumerate(mapping("layers", layers).items()):
        if not isinstance(description, (tuple, list)) or len(description) not in (2, 3):
            raise wrong(f"layer {name}", description, "not (dtype, components) or (dtype, components, scope)")
        dtype, components, *scope = description
        components = texts(f"layer {name}: components", components) if not isinstance(components, str) else list(components)
        if not components:
            raise wrong(f"layer {name}", description, "without components")
        semantic = VOCABULARY.get(name, ("", 0))[1]
        channels += [Channel(f"{name}.{component}", group, dtype, semantic, scope[0] if scope else "sample")
                     for component in components]
    return channels


def _members(channels):
    layers = {}
    for channel in channels:
        layers.setdefault(channel.name.partition(".")[0], []).append(channel)
    return layers


def _invalid(text):
    return SpoolError("invalid", text)

"""What IMAG declares, and every size that follows from it. Python's integers do not overflow, so the sizes are exact."""
from dataclasses import dataclass

import numpy as np

from . import record_layout as layout
from .error import SpoolError


@dataclass(frozen=True)
class Geometry:
    width: int
    height: int
    tile_size: int
    spp: int
    block_spp: int
    group_count: int
    channel_count: int
    pixel_filter: int = 0
    colour_space: int = 0
    sample_order: int = 0

    @property
    def tiles_x(self):
        return -(-self.width // self.tile_size)

    @property
    def tiles_y(self):
        return -(-self.height // self.tile_size)

    def rectangle(self, tile):
        """(x0, y0, x1, y1) of a tile, cropped to the image."""
        y, x = divmod(tile, self.tiles_x)
        return (x * self.tile_size, y * self.tile_size,
                min((x + 1) * self.tile_size, self.width), min((y + 1) * self.tile_size, self.height))

    def tile_count(self, scope):
        return 1 if scope == "pass" else self.tiles_x * self.tiles_y

    def sample_count(self, scope):
        return 1 if scope == "pixel" else self.spp

    def block_count(self, scope):
        """Blocks of one tile."""
        return 1 if scope == "pixel" else -(-self.spp // self.block_spp)

    def block_shape(self, scope, channels, tile, begin):
        """[c][y][x][s] of one DATA record; the tile and the first sample must exist."""
        samples = 1 if scope == "pixel" else min(self.block_spp, self.spp - begin)
        if scope == "pass":
            return channels, 1, 1, samples
        x0, y0, x1, y1 = self.rectangle(tile)
        return channels, y1 - y0, x1 - x0, samples

    def encode(self):
        image = np.zeros((), layout.IMAG)
        for name in layout.IMAG.names[:-1]:
            image[name] = getattr(self, name)
        return image.tobytes()

    @staticmethod
    def decode(payload, newer_minor):
        image = np.frombuffer(payload, layout.IMAG)[0]
        if image["reserved"].tobytes().strip(b"\0") and not newer_minor:
            raise SpoolError("invalid", "reserved bytes are not zero (IMAG)")
        geometry = Geometry(*(int(image[name]) for name in layout.IMAG.names[:-1]))
        geometry.validate()
        return geometry

    def validate(self):
        """The rules of section 4.1, for reader and writer alike."""
        for name, low, high in (("width", 1, layout.MAX_SIDE), ("height", 1, layout.MAX_SIDE),
                                ("tile_size", layout.MIN_TILE, layout.MAX_TILE),
                                ("spp", 1, layout.MAX_SPP), ("block_spp", 1, layout.MAX_BLOCK_SPP),
                                ("group_count", 1, layout.MAX_GROUPS),
                                ("channel_count", layout.MIN_CHANNELS, layout.MAX_CHANNELS),
                                ("pixel_filter", 0, len(layout.PIXEL_FILTERS) - 1),
                                ("colour_space", 0, len(layout.COLOUR_SPACES) - 1),
                                ("sample_order", 0, len(layout.SAMPLE_ORDERS) - 1)):
            if not low <= getattr(self, name) <= high:
                raise SpoolError("invalid", f"{name} is {getattr(self, name)}, not {low} to {high} (IMAG)")
        if self.tile_size & (self.tile_size - 1):
            raise SpoolError("invalid", f"tile_size is {self.tile_size}, not a power of two (IMAG)")
        if self.width * self.height > layout.MAX_PIXELS:
            raise SpoolError("invalid", f"{self.width}x{self.height} are more than 2^28 pixels (IMAG)")

    def validate_groups(self, groups):
        """The limits of section 6 that need the groups: list of (scope, dtype, channel count)."""
        for number, (scope, dtype, channels) in enumerate(groups):
            shape = self.block_shape(scope, channels, 0, 0)
            size = shape[0] * shape[1] * shape[2] * shape[3] * dtype.itemsize
            if size > layout.MAX_RAW_BYTES:
                raise SpoolError("invalid", f"a block of {size} bytes is larger than 64 MiB (group {number})")
        blocks = self.total_blocks(groups)
        if blocks > layout.MAX_BLOCKS:
            raise SpoolError("invalid", f"{blocks} blocks are more than {layout.MAX_BLOCKS} (IMAG)")

    def total_blocks(self, groups):
        return sum(self.tile_count(scope) * self.block_count(scope) for scope, _, _ in groups)


def groups_of(channels):
    """(scope, dtype, channel count) of each group."""
    groups = []
    for channel in channels:
        if channel.group == len(groups):
            groups.append([channel.scope, np.dtype(channel.dtype), 0])
        groups[channel.group][2] += 1
    return [tuple(group) for group in groups]

"""Images as text in the page: half floats, floats or counts, bytes sorted by weight, deflated, base64.

The browser undoes it with DecompressionStream (image_codec.js). Halves keep eleven bits.
"""

import base64
import math
import zlib
from typing import NamedTuple

import numpy as np

LARGEST_HALF = 65504.0
SMALLEST_HALF = 2.0 ** -14  # of eleven bits
STRETCHED_MAXIMUM = 16384.0


class Packed(NamedTuple):
    width: int
    height: int
    channels: int
    kind: str  # half, float, count
    scale: float  # stored value * scale = value
    text: str  # base64
    values: np.ndarray  # [y][x] or [y][x][c], as they were

    def header(self):
        """What the page's scripts read before the text."""
        return {"width": self.width, "height": self.height, "channels": self.channels, "kind": self.kind, "scale": self.scale}

    @property
    def size(self):
        return len(self.text)


def pack_half(image, stretch):
    """`stretch`: the largest magnitude is brought to the upper end of half's range. Floats where one large value would
    take the others below that range."""
    image = np.asarray(image, np.float32)
    finite = np.abs(image[np.isfinite(image)])
    largest = float(finite.max()) if finite.size else 0.0
    scale = 1.0
    if largest > 0.0 and (stretch or largest > LARGEST_HALF or largest < 2.0 ** -6):
        scale = 2.0 ** math.ceil(math.log2(largest / STRETCHED_MAXIMUM))
    if scale != 1.0 and np.mean(finite[finite > 0.0] < scale * SMALLEST_HALF) > 0.01:
        return _pack(image, image.astype("<f4"), "float", 1.0)
    with np.errstate(over="ignore", invalid="ignore"):
        stored = (image.astype(np.float64) / scale).astype("<f2")
    return _pack(image, stored, "half", scale)


def pack_counts(image):
    """Whole numbers up to 65535; larger ones are divided by a power of two."""
    largest = float(np.nanmax(image)) if image.size else 0.0
    scale = 1.0
    while largest / scale > 65535.0:
        scale *= 2.0
    stored = np.clip(np.rint(np.nan_to_num(image) / scale), 0, 65535).astype("<u2")
    return _pack(image, stored, "count", scale)


def _pack(image, stored, kind, scale):
    height, width = image.shape[:2]
    channels = image.shape[2] if image.ndim == 3 else 1
    planes = np.ascontiguousarray(np.moveaxis(stored.reshape(height, width, channels), 2, 0))
    by_weight = planes.view(np.uint8).reshape(-1, planes.itemsize).T
    text = base64.b64encode(zlib.compress(by_weight.tobytes(), 6)).decode("ascii")
    return Packed(width, height, channels, kind, scale, text, image)

"""The windows that insets show: those asked for, or those where the methods differ most to the eye on something that one
recognises."""

import numpy as np

from tools.report.failure import USAGE, Failure
from tools.report.result_images import Crop, tone_mapped, window_sums

MOST_WINDOWS = 4
ENOUGH_CONTRAST = 0.25  # standard deviation of three channels together
MOST_STRETCHED = 4  # times as wide as high, or as high as wide


def asked_windows(texts, labels):
    """{recording, or "" for those without windows of their own: [Crop]} of "x,y,w,h" and "RECORDING:x,y,w,h"."""
    windows = {}
    for text in texts:
        name, _, numbers = text.rpartition(":")
        if name and name not in labels:
            raise Failure(f"--crops {text[:80]}: no recording {name[:60]}; there are {', '.join(labels)}", USAGE)
        parts = [part.strip() for part in numbers.split(",")]
        if len(parts) != 4 or not all(part.isascii() and part.isdigit() and len(part) < 10 for part in parts):
            raise Failure(f"--crops {text[:80]}: give X,Y,W,H or RECORDING:X,Y,W,H, whole numbers of pixels", USAGE)
        crop = Crop(*map(int, parts))
        if not crop.width or not crop.height or max(crop[2:]) > MOST_STRETCHED * min(crop[2:]):
            raise Failure(f"--crops {text[:80]}: a window has at least one pixel and is at most {MOST_STRETCHED} times as "
                          "wide as high or as high as wide", USAGE)
        windows.setdefault(name, []).append(crop)
    for name, crops in windows.items():
        if len(crops) > MOST_WINDOWS:
            raise Failure(f"--crops: {len(crops)} windows{' of ' + name if name else ''}: give at most {MOST_WINDOWS}", USAGE)
    return windows


def inside(crops, shape, label):
    """`crops`, which must lie in a picture of this shape."""
    height, width = shape[:2]
    for c in crops:
        if c.x + c.width > width or c.y + c.height > height:
            raise Failure(f"--crops {','.join(map(str, c))}: not inside {label}, which has {width} x {height} pixels; "
                          "RECORDING:X,Y,W,H is for one recording only", USAGE)
    return crops


def choose_windows(images, reference, exposure, count=2):
    """Square windows of a fifth of the shorter side, apart from each other and off the border. The score of a window
    is how far the methods' mean errors in it lie apart as they are seen, times the contrast of the blurred reference in it,
    colours too, times what is neither black nor white of it beyond a half. A lamp's edge is no more contrast than enough."""
    truth = tone_mapped(reference, exposure).astype(np.float64) / 255.0
    height, width = truth.shape[:2]
    side = min(height, width, max(16, min(height, width) // 5))
    border = min(1 + max(height, width) // 100, (height - side) // 2, (width - side) // 2)
    errors = [np.abs(tone_mapped(image, exposure) / 255.0 - truth).mean(axis=2) for image in images]
    apart = np.std([_mean(error, side) for error in errors], axis=0)
    planes = [_mean(np.pad(truth[..., c], 1, mode="edge"), 3) for c in range(3)]
    spread = sum(np.maximum(_mean(plane ** 2, side) - _mean(plane, side) ** 2, 0.0) for plane in planes)
    contrast = np.minimum(np.sqrt(spread), ENOUGH_CONTRAST)
    told = _mean(((np.max(planes, axis=0) > 0.06) & (np.min(planes, axis=0) < 0.97)).astype(float), side)
    score = (apart / (apart.max() or 1.0) + 0.05) * (contrast / (contrast.max() or 1.0) + 0.05) * np.maximum(told - 0.5, 0.01)
    score = score[border:score.shape[0] - border, border:score.shape[1] - border]
    ys, xs = np.mgrid[0:score.shape[0], 0:score.shape[1]]
    windows = []
    for _ in range(count):
        y, x = np.unravel_index(np.argmax(score), score.shape)
        windows.append(Crop(int(x) + border, int(y) + border, side, side))
        distance = np.maximum(np.abs(ys - y), np.abs(xs - x))  # below `side` they meet
        score = score * np.clip((distance - side) / (0.5 * side), 1e-9, 1.0)
    return windows


def _mean(image, side):
    """Of every square window of that side."""
    return window_sums(image, side, side) / side ** 2

"""Two windows where two images differ most in their error against the reference: what insets show."""

import numpy as np

from result_images import Crop


def relative_error(image, reference):
    """[y][x] squared difference relative to the reference, summed over channels."""
    scale = float(np.mean(reference[np.isfinite(reference)])) or 1.0
    truth = reference.astype(np.float64) / scale
    difference = image.astype(np.float64) / scale - truth
    return np.nan_to_num((difference ** 2 / (truth ** 2 + 0.01)).sum(axis=2), nan=0.0, posinf=0.0)


def choose_windows(a, b, reference, count=2):
    """Square windows of a sixth of the shorter side that do not meet; outliers are capped, so that none chooses alone."""
    score = np.abs(relative_error(a, reference) - relative_error(b, reference))
    height, width = score.shape
    side = min(height, width, max(8, min(height, width) // 6))
    flat = np.partition(score.ravel(), int(0.98 * (score.size - 1)))
    capped = np.minimum(score, flat[int(0.98 * (score.size - 1))] or np.inf)
    sums = np.pad(np.cumsum(np.cumsum(capped, 0), 1), ((1, 0), (1, 0)))
    total = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    windows = []
    for _ in range(count):
        y, x = np.unravel_index(np.argmax(total), total.shape)
        windows.append(Crop(int(x), int(y), side, side))
        total[max(0, y - side + 1):y + side, max(0, x - side + 1):x + side] = -1.0
    return windows

"""Prints the constants of perceptual_metrics_test.cpp, computed by other people's programs.

Needs numpy, scikit-image 0.26 and flip-evaluator 1.7 from PyPI. The images are the formulas of that
test.
"""

import flip_evaluator
import numpy as np
from skimage.metrics import structural_similarity

WIDTH, HEIGHT = 100, 80


def images(hdr):
    y, x, c = np.mgrid[0:HEIGHT, 0:WIDTH, 0:3]
    base = 0.1 + 0.8 * ((x // 9 + y // 7) % 2) * (c + 1) / 3
    noise = (x * 7919 + y * 104729 + c * 15485863) % 1009 / 1009 - 0.5
    scale = 2.0 ** (y / 10 - 4) if hdr else 1.0
    return scale * base, scale * np.maximum(base + 0.3 * noise, 0)


def srgb(v):
    v = np.clip(v, 0, 1)
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)


def flip(hdr):
    reference, test = (image.astype(np.float32) for image in images(hdr))
    if not hdr:
        reference, test = np.clip(reference, 0, 1), np.clip(test, 0, 1)
    _, mean, parameters = flip_evaluator.evaluate(
        reference, test, "HDR" if hdr else "LDR", inputsRGB=False, applyMagma=False)
    return mean, parameters


def ssim():
    a, b = (srgb(image) @ [0.2126, 0.7152, 0.0722] for image in images(False))
    return structural_similarity(a, b, gaussian_weights=True, sigma=1.5,
                                 use_sample_covariance=False, data_range=1.0)


if __name__ == "__main__":
    print("ssim     %.10f" % ssim())
    print("flip_ldr %.7f" % flip(False)[0])
    mean, parameters = flip(True)
    print("flip_hdr %.7f" % mean, {k: parameters[k] for k in
                                   ("startExposure", "stopExposure", "numExposures")})

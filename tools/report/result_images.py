"""Finds the images that `spool evaluate` wrote beside results.csv and packs them for the page.

Folders are named DUMP_SAMPLER_FILTER_SPPspp; they hold estimate, squared_error, density, filter_size
and direction as .exr. The reference lies in the folder of each result, or once per recording as
DUMP_reference.exr. Every result of a recording is cropped alike, so that pages flip in place.
"""

import math
import os
import subprocess
from typing import NamedTuple
from urllib.parse import quote

import numpy as np

from tools.report.exr_image import read_exr, rgb, single
from tools.report.file_names import LONGEST_STEM, bounded, dump_names, file_name_of
from tools.report.image_packing import pack_counts, pack_half
from tools.report.results_table import without_threads

PICTURES = ("estimate", "reference", "squared_error", "density", "filter_size", "direction", "flip")
COLOUR = {"estimate", "reference"}
MAPS_AT_ONCE = 500  # names in one command line
FIRST_METHODS = 10  # of many results: 256 of 128 x 128 pixels are a page of less than 8 MB
SMALL_BYTES = 16e6  # of the EXR files of all results; in the page a third of it
SMALLEST_CROP = 96  # pixels; below, results are left out instead
BYTES_PER_MB = 1e6


class Crop(NamedTuple):
    x: int
    y: int
    width: int
    height: int

    def of(self, image):
        return image[self.y:self.y + self.height, self.x:self.x + self.width]


class PictureSet(NamedTuple):
    combination: int  # index
    images: dict  # picture: index into ResultImages.packed; empty where only links fit
    links: dict  # picture: address of the EXR relative to the report


class ResultImages(NamedTuple):
    packed: list  # of Packed
    sets: list  # of PictureSet
    crops: dict  # recording: Crop, where not the whole image
    sizes: dict  # recording: (width, height)
    left_out: int  # sets with links only
    bytes: int  # in the page


class _Found(NamedTuple):
    combination: int
    dump: str
    paths: dict  # picture: path


def find_images(folder, combinations, recordings):
    """`recordings`: all of the plan, in its order; no two have one file name, and their folders may have moved."""
    names = dump_names(dict.fromkeys(os.path.basename(path) for path in [*recordings, *(c.dump for c in combinations)]))
    found = []
    for index, c in enumerate(combinations):
        stem = bounded("_".join([names[os.path.basename(c.dump)], file_name_of(without_threads(c.sampler)), file_name_of(c.filter),
                                 f"{c.spp:g}spp"]), LONGEST_STEM)
        paths = {name: folder / stem / f"{name}.exr" for name in PICTURES}
        if not paths["reference"].exists():
            paths["reference"] = folder / f"{names[os.path.basename(c.dump)]}_reference.exr"
        paths = {name: path for name, path in paths.items() if path.is_file()}
        if "estimate" in paths:
            found.append(_Found(index, c.dump, paths))
    return found


def first_results(found, combinations, statistics, metric):
    """All of them while they are small together; else the baseline and the first methods of each recording and budget."""
    if sum(path.stat().st_size for entry in found for path in entry.paths.values()) <= SMALL_BYTES:
        return found
    conditions = statistics.of_metric(metric) or statistics.of_metric(next(iter(statistics.metrics()), ""))
    place = {(c["dump"], c["spp"], e["sampler"], e["filter"]): i for c in conditions for i, e in enumerate(c["ranking"])}
    number, first = {}, []
    for entry in found:
        combination = combinations[entry.combination]
        condition = combination.dump, combination.spp
        number[condition] = number.get(condition, 0) + 1
        if place.get(combination.key, number[condition]) < FIRST_METHODS or combination.method == statistics.baseline:
            first.append(entry)
    return first


def with_flip_maps(found, program):
    """The maps that are not there are made; a result without one is shown without it."""
    missing = [entry.paths["estimate"].parent for entry in found if "flip" not in entry.paths and "reference" in entry.paths]
    if not missing or not program:
        return found
    words = [f"--flip-map={folder.name}" for folder in missing]
    try:
        for first in range(0, len(words), MAPS_AT_ONCE):
            subprocess.run([program, "picture", *words[first:first + MAPS_AT_ONCE], "--", str(missing[0].parent)], capture_output=True, check=False)
    except OSError:
        return found
    for entry in found:
        path = entry.paths["estimate"].with_name("flip.exr")
        if path.is_file():
            entry.paths["flip"] = path
    return found


def pack_images(found, page_folder, max_mb):
    """As many images as `max_mb` megabytes of page hold: crops first, then fewer results."""
    budget = max_mb * BYTES_PER_MB
    crops, sizes = _choose_crops(found, budget)
    images = ResultImages([], [], {d: c for d, c in crops.items()
                                   if (c.width, c.height) != sizes[d]}, sizes, 0, 0)
    stored, total, left_out = {}, 0, 0
    sets = {}
    for entry in _in_turn(found):
        packed = {}
        for name, path in entry.paths.items():
            if path not in stored:
                packed[name] = _pack(name, path, crops[entry.dump], sizes[entry.dump])
        cost = sum(p.size for p in packed.values() if p)
        links = {name: quote(os.path.relpath(path, page_folder)) for name, path in entry.paths.items()}
        if total + cost > budget:
            left_out += 1
            sets[entry.combination] = PictureSet(entry.combination, {}, links)
            continue
        total += cost
        for name, image in packed.items():
            stored[entry.paths[name]] = len(images.packed) if image else None
            if image:
                images.packed.append(image)
        shown = {name: stored[path] for name, path in entry.paths.items()
                 if stored.get(path) is not None}
        sets[entry.combination] = PictureSet(entry.combination, shown, links)
    ordered = [sets[entry.combination] for entry in found]
    return images._replace(sets=ordered, left_out=left_out, bytes=total)


def _choose_crops(found, budget):
    """One window per recording; its side follows from the size of one packed result of each."""
    first, number = {}, {}
    for entry in found:
        first.setdefault(entry.dump, entry)
        number[entry.dump] = number.get(entry.dump, 0) + 1
    sizes, whole, error = {}, {}, {}
    expected = 0.0
    for dump, entry in first.items():
        estimate = rgb(read_exr(entry.paths["estimate"]))
        sizes[dump] = (estimate.shape[1], estimate.shape[0])
        whole[dump] = Crop(0, 0, *sizes[dump])
        for name, path in entry.paths.items():
            packed = _pack(name, path, whole[dump], sizes[dump])
            expected += (packed.size if packed else 0) * (
                1 if name == "reference" else number[dump])
        if "squared_error" in entry.paths:
            error[dump] = single(read_exr(entry.paths["squared_error"]))
    if expected <= budget:
        return whole, sizes
    share = 0.97 * math.sqrt(budget / expected)
    return {dump: _window(size, share, error.get(dump)) for dump, size in sizes.items()}, sizes


def _window(size, share, error):
    """The window with the largest error, outliers capped so that no single pixel chooses it."""
    width, height = (min(side, max(SMALLEST_CROP, round(side * share))) for side in size)
    if error is None or error.shape != (size[1], size[0]):
        return Crop((size[0] - width) // 2, (size[1] - height) // 2, width, height)
    finite = np.where(np.isfinite(error), error, 0.0).astype(np.float64)
    capped = np.clip(finite, 0.0, np.quantile(finite, 0.99))
    sums = window_sums(capped, width, height)
    y, x = np.unravel_index(np.argmax(sums), sums.shape)
    return Crop(int(x), int(y), width, height)


def window_sums(image, width, height):
    """Of every window of that size."""
    sums = np.pad(np.cumsum(np.cumsum(image, 0), 1), ((1, 0), (1, 0)))
    return sums[height:, width:] - sums[:-height, width:] - sums[height:, :-width] + sums[:-height, :-width]


def _in_turn(found):
    """One result of each recording after the other, so that a small budget shows some of each."""
    queues = {}
    for entry in found:
        queues.setdefault(entry.dump, []).append(entry)
    for i in range(max(map(len, queues.values()), default=0)):
        yield from (queue[i] for queue in queues.values() if i < len(queue))


def _pack(name, path, crop, size):
    """None where the image has another size than the estimate: pieces smaller than a pixel."""
    planes = read_exr(path)
    image = rgb(planes) if name in COLOUR else single(planes)
    if image.shape[:2] != (size[1], size[0]):
        if image.shape[0] % size[1] or image.shape[1] % size[0]:
            return None
        image = image[::image.shape[0] // size[1], ::image.shape[1] // size[0]]
    if name == "density":
        return pack_counts(crop.of(image))
    return pack_half(crop.of(image), stretch=name == "squared_error")


def exposure_and_mean(image):
    """EV that brings the log-average luminance to middle grey, in half steps; and the mean luminance."""
    luminance = image @ np.array([0.2126, 0.7152, 0.0722])
    luminance = luminance[np.isfinite(luminance)]
    if luminance.size == 0:
        return 0.0, 1.0
    mean = float(np.mean(luminance))
    floor = min(max(1e-4, 1e-6 * mean), 1e-2 * mean) if mean > 0.0 else 1e-4  # lib/core/log_average.h
    grey = math.exp(float(np.mean(np.log(np.maximum(luminance, 0.0) + floor))))
    return round(2.0 * math.log2(0.18 / grey)) / 2.0, mean if mean > 0.0 else 1.0


def tone_mapped(image, exposure):
    """sRGB bytes [y][x][c] of linear values at `exposure` EV; what is not finite is magenta."""
    linear = np.clip(np.nan_to_num(image.astype(np.float64)) * 2.0 ** exposure, 0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    result = np.rint(255.0 * encoded).astype(np.uint8)
    result[~np.isfinite(image).all(axis=2)] = (255, 0, 200)
    return result

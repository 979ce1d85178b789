"""What was recorded at a few pixels of each recording, for the page: the program's own answer (`spool pixel --json`).

The order is that of replicate 0, whose pictures the page shows: a sampler that took n samples took the first n. Weights of
filters that can say them come from the same sampler and filter, run once more.
"""

import json
import re
import resource
import subprocess
import time
from pathlib import Path

import numpy as np

from tools.report.exr_image import read_exr, rgb
from tools.report.number_text import in_digits

MOST_PIXELS = 12  # of a recording
MOST_SAMPLES = 256
SECONDS = 300
MOST_FOOTPRINTS = 8  # results of a recording, those of the largest budgets: each is sampled and filtered once more
FOOTPRINT_SECONDS = 60  # for all of them; later ones are left out
FOOTPRINT_SHARE, FOOTPRINT_CPU = 0.02, 0.8  # of the CPU seconds of all results, or so many, in equal parts for each recording
METHOD = r"(\w+)(?::\w+)?(?:\{[^{}]*\})?"  # lib/methods/method_text.h, without a label
LEAST_WEIGHT = 1e-3  # of the largest: smaller ones are not drawn
JUDGED_APART = ("independent", "leave_selected_out")  # nothing is held out of the list


def relative_error(image, reference):
    """[y][x] squared difference relative to the reference, summed over channels."""
    scale = float(np.mean(reference[np.isfinite(reference)])) or 1.0
    truth = reference.astype(np.float64) / scale
    difference = image.astype(np.float64) / scale - truth
    return np.nan_to_num((difference ** 2 / (truth ** 2 + 0.01)).sum(axis=2), nan=0.0, posinf=0.0)


def pixel_answers(program, found, combinations, manifest, vocabulary):
    """{recording: {"answers": [answer], "footprints": {combination: [footprint]}}}; nothing where the order is not known, or the recording is not there any more."""
    known = replay_order(manifest)
    if not program or known is None:
        return {}
    order = ["--order", "recorded"] if known == "recorded" else ["--evaluation-seed", str(known)]
    paths = recording_paths(manifest)
    answers, end = {}, time.monotonic() + FOOTPRINT_SECONDS
    dumps = list(dict.fromkeys(entry.dump for entry in found))
    seconds = max(FOOTPRINT_CPU, FOOTPRINT_SHARE * sum(cpu_seconds(row) for c in combinations for row in c.rows)) / max(len(dumps), 1)
    for dump in dumps:
        path = paths.get(Path(dump).name)
        rows = [row for c in combinations if c.dump == dump for row in c.rows]
        if path is None or not Path(path).is_file() or any(row.get("reference") not in JUDGED_APART for row in rows):
            continue
        of_dump = [entry for entry in found if entry.dump == dump]
        places = choose_pixels([entry.paths for entry in of_dump])
        answer = ask(program, path, order, places)
        if answer:
            asked = {entry.combination: combinations[entry.combination] for entry in of_dump}
            answers[dump] = {"answers": answer, "footprints": affordable_footprints(
                asked, seconds, end, lambda c, path=path, places=places: footprints_of(program, path, order, places, c, vocabulary))}
    return answers


def affordable_footprints(combinations, seconds, end, told_of):
    """{index: [footprint]} of those of the largest budgets that so many CPU seconds allow, until `end`."""
    footprints = {}
    for index, combination in sorted(combinations.items(), key=lambda item: -item[1].spp):
        if len(footprints) == MOST_FOOTPRINTS or time.monotonic() >= end:
            break
        if not combination.rows or cpu_seconds(combination.rows[0]) > seconds:
            continue
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        told = told_of(combination)
        seconds -= resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before  # weights can cost more than the result did
        if told:
            footprints[index] = told
    return footprints


def cpu_seconds(row):
    """Of sampling and filtering once; 0 where it is not known."""
    values = [float(row.get(name) or 0.0) for name in ("cpu_sampling", "cpu_filtering")]
    return sum(value for value in values if np.isfinite(value))


def replay_order(manifest):
    """"recorded", or the seed of an evaluation whose replicate 0 takes the samples of pixels in the order that the seed
    says; None where pixels have no such order."""
    plan = manifest.get("plan")
    if not isinstance(plan, dict) or plan.get("pieces_per_side", 1) != 1 or plan.get("decision_split"):
        return None
    if not isinstance(plan.get("seed"), int) or plan.get("order") not in ("recorded", "disjoint", "shuffled"):
        return None
    return "recorded" if plan["order"] == "recorded" else plan["seed"]


def recording_paths(manifest):
    """{file name: path} of the recordings that were evaluated."""
    return {Path(str(d.get("path"))).name: str(d.get("file") or d["path"]) for d in manifest.get("dumps", [])  # without: an older program
            if isinstance(d, dict) and d.get("path")}


def evaluated(manifest, statistics):
    """The recordings in the order of their plan; scene by scene where an older program wrote no manifest."""
    return [str(d["path"]) for d in manifest.get("dumps", []) if isinstance(d, dict) and d.get("path")] or statistics.recordings()


def footprints_of(program, path, order, places, combination, vocabulary):
    """[{"taps": [[dx, dy, weight]], "shapes"}] of the places; nothing where the filter does not say. Only methods of the
    program itself are run: the names come from a folder that anybody may have made."""
    written = [re.fullmatch(METHOD, label) for label in (combination.sampler, combination.filter)]
    names = [found.group(1) if found else "" for found in written]
    if names[0] not in vocabulary.samplers or names[1] not in vocabulary.telling_filters:
        return []
    more = ["--samples", "1", f"--sampler={combination.sampler}", f"--filter={combination.filter}", f"--spp={combination.spp:g}"]
    told = [pixel.get("footprint") for pixel in ask(program, path, [*order, *more], places, ())]
    return [_drawn(*place, footprint) for place, footprint in zip(places, told)] if told and all(told) else []


def _drawn(x, y, footprint):
    most = max((abs(tap[2]) for tap in footprint["taps"]), default=0.0)
    taps = [[tap[0] - x, tap[1] - y, tap[2]] for tap in footprint["taps"] if abs(tap[2]) >= LEAST_WEIGHT * most]
    return {"taps": taps, "shapes": footprint["shapes"]}


def ask(program, path, order, places, samples=("--samples", str(MOST_SAMPLES))):
    words = [program, "pixel", "--json", *order, *samples]
    words += [word for x, y in places for word in ("--at", f"{x},{y}")]
    try:
        done = subprocess.run([*words, "--", path], capture_output=True, timeout=SECONDS, check=False)
        return in_digits(json.loads(done.stdout), 5) if done.returncode == 0 else []  # more than is shown
    except (OSError, ValueError, subprocess.TimeoutExpired):
        return []


def choose_pixels(path_sets):
    """Where the first result is worst, where the first and the last differ most, and evenly spread ones."""
    with_reference = [paths for paths in path_sets if "reference" in paths]
    if not with_reference:
        return []
    reference = rgb(read_exr(with_reference[0]["reference"]))
    first, last = (relative_error(rgb(read_exr(paths["estimate"])), reference) for paths in (path_sets[0], path_sets[-1]))
    height, width = first.shape
    places, apart = [], max(2, min(width, height) // 10)
    for score in [first] * 4 + [np.abs(first - last)] * 4:
        score = score.copy()
        for x, y in places:
            score[max(0, y - apart):y + apart + 1, max(0, x - apart):x + apart + 1] = -1.0
        y, x = np.unravel_index(np.argmax(score), score.shape)
        if score[y, x] >= 0.0:
            places.append((int(x), int(y)))
    places += [(fx * width // 4, fy * height // 4) for fy in (1, 3) for fx in (1, 3)]
    return list(dict.fromkeys(places))[:MOST_PIXELS]

"""What was recorded at a few pixels of each recording, for the page: the program's own answer (`spool pixel --json`).

The order is that of replicate 0, whose pictures the page shows: a sampler that took n samples took the first n.
"""

import json
import subprocess
from pathlib import Path

import numpy as np

from exr_image import read_exr, rgb
from inset_windows import relative_error

MOST_PIXELS = 12  # of a recording
MOST_SAMPLES = 256
SECONDS = 300
JUDGED_APART = ("independent", "leave_selected_out")  # nothing is held out of the list


def pixel_answers(program, found, combinations, manifest):
    """{recording: [answer]}; nothing where the order is not known, or the recording is not there any more."""
    plan = manifest.get("plan")
    if not program or not isinstance(plan, dict):
        return {}
    plain = plan.get("pieces_per_side", 1) == 1 and not plan.get("decision_split") and isinstance(plan.get("seed"), int)
    order = {"recorded": ["--order", "recorded"], "disjoint": ["--evaluation-seed", str(plan.get("seed"))],
             "shuffled": ["--evaluation-seed", str(plan.get("seed"))]}.get(plan.get("order"))
    if not plain or order is None:
        return {}
    paths = {Path(str(d.get("path"))).name: str(d["path"]) for d in manifest.get("dumps", [])
             if isinstance(d, dict) and d.get("path")}
    answers = {}
    for dump in dict.fromkeys(entry.dump for entry in found):
        path = paths.get(Path(dump).name)
        rows = [row for c in combinations if c.dump == dump for row in c.rows]
        if path is None or not Path(path).is_file() or any(row.get("reference") not in JUDGED_APART for row in rows):
            continue
        places = choose_pixels([entry.paths for entry in found if entry.dump == dump])
        answer = ask(program, path, order, places)
        if answer:
            answers[dump] = answer
    return answers


def ask(program, path, order, places):
    words = [program, "pixel", "--json", *order, "--samples", str(MOST_SAMPLES)]
    words += [word for x, y in places for word in ("--at", f"{x},{y}")]
    try:
        done = subprocess.run([*words, "--", path], capture_output=True, timeout=SECONDS, check=False)
        return [_short(pixel) for pixel in json.loads(done.stdout)] if done.returncode == 0 else []
    except (OSError, ValueError, subprocess.TimeoutExpired):
        return []


def _short(value):
    """Five digits of every number: more than is shown."""
    if isinstance(value, dict):
        return {key: _short(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_short(item) for item in value]
    return float(f"{value:.5g}") if isinstance(value, float) else value


def choose_pixels(path_sets):
    """Where the first result is worst, where the first and the last differ most, and evenly spread ones."""
    with_reference = [paths for paths in path_sets if "reference" in paths]
    if not with_reference:
        return []
    reference = rgb(read_exr(with_reference[0]["reference"]))
    first, last = (relative_error(rgb(read_exr(paths["estimate"])), reference) for paths in (path_sets[0], path_sets[-1]))
    height, width = first.shape
    places, apart = [], max(2, min(width, height) // 10)

    def take(score, count):
        score = score.copy()
        for x, y in places:
            score[max(0, y - apart):y + apart + 1, max(0, x - apart):x + apart + 1] = -1.0
        for _ in range(count):
            y, x = np.unravel_index(np.argmax(score), score.shape)
            if score[y, x] < 0.0:
                return
            places.append((int(x), int(y)))
            score[max(0, y - apart):y + apart + 1, max(0, x - apart):x + apart + 1] = -1.0

    take(first, 4)
    take(np.abs(first - last), 4)
    for fy in (1, 3):
        for fx in (1, 3):
            places.append((fx * width // 4, fy * height // 4))
    return list(dict.fromkeys(places))[:MOST_PIXELS]

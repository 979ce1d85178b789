"""Running mean and variance of the mean of the reference, by chunks, in double precision.

Chunks are merged pairwise in order by the update of Chan, Golub and LeVeque; sums of squares are not used.
Non-finite samples are left out and counted. A state keeps how its samples are cut into chunks: the same number of chunks
holds other samples when it is cut otherwise.
"""
import numpy as np

from dumps.recording.reference_need import DENOMINATOR, denominator_noise, judged_at


def empty_reference(height, width):
    return {"count": np.zeros((height, width, 1)), "mean": np.zeros((height, width, 3)), "m2": np.zeros((height, width, 3)),
            **dict.fromkeys(("chunks", "nonfinite", "looked_at", "repeated", "left_out"), np.int64(0)), "seconds": np.float64(0)}


def begun_or_empty(stored, samples, parts, height, width):
    """(state to go on from, whether what was stored is of no use); stored: a state or None; parts: of Cut, for `samples`."""
    cut = np.array([samples, parts[0][1], parts[0][2][1]])                    # samples in all, in a chunk, rows in a chunk
    bands = sum(first == 0 for first, _, _ in parts)
    empty = {**empty_reference(height, width), "cut": cut, "ended": np.zeros(bands, bool)}
    if stored is None:
        return empty, False
    done = int(stored["chunks"])           # are the samples there those of the first parts?
    expected = sum(count * (rows[1] - rows[0]) * width for _, count, rows in parts[:done])
    there = int(stored["count"].sum()) + int(stored["nonfinite"]) + int(stored.get("left_out", 0))
    fits = done <= len(parts) and there == expected and np.array_equal(stored.get("cut", cut)[1:], cut[1:])
    return ({**empty, **stored, "cut": cut}, False) if fits else (empty, True)


def judged(state, part):
    """The state before this part is drawn: its band ends where the samples there suffice (reference_need.py)."""
    first, _, rows = part
    band = int(state["chunks"]) % len(state["ended"])
    if judged_at(first) and not state["ended"][band]:
        ended = state["ended"].copy()
        ended[band] = denominator_noise(state["mean"][slice(*rows)], variance_of_mean(state)[slice(*rows)]) <= DENOMINATOR
        return {**state, "ended": ended}
    return state


def is_left_out(state):
    return bool(state["ended"][int(state["chunks"]) % len(state["ended"])])


def left_out(state, part):
    _, count, rows = part
    lost = count * (rows[1] - rows[0]) * state["count"].shape[1]
    return {**state, "chunks": state["chunks"] + 1, "left_out": state["left_out"] + lost}


def add_chunk(state, radiance, seconds, rows=None):
    """radiance: [y][x][s][3] float32, of the rows [first, end) or of all."""
    if rows is not None:
        whole = {name: state[name].copy() for name in ("count", "mean", "m2")}
        band = add_chunk({**state, **{name: value[slice(*rows)] for name, value in whole.items()}}, radiance, seconds)
        for name, value in whole.items():
            value[slice(*rows)] = band[name]
        return {**band, **whole}
    finite = np.isfinite(radiance).all(axis=3, keepdims=True)
    values = np.where(finite, radiance, 0).astype(np.float64)
    count = finite.sum(axis=2).astype(np.float64)
    mean = values.sum(axis=2) / np.maximum(count, 1)
    m2 = (np.where(finite, values - mean[:, :, None], 0) ** 2).sum(axis=2)
    total = state["count"] + count
    delta = mean - state["mean"]
    share = count / np.maximum(total, 1)
    return {**state, "count": total, "mean": state["mean"] + delta * share,
            "m2": state["m2"] + m2 + delta ** 2 * state["count"] * share, "chunks": state["chunks"] + 1,
            "nonfinite": state["nonfinite"] + int((~finite).sum()), "seconds": state["seconds"] + seconds}


def variance_of_mean(state):
    count = np.maximum(state["count"], 2)
    return state["m2"] / (count - 1) / count


def pixels_of(state):
    """(mean, variance of the mean) as the file has them: a pixel without a finite sample is not black, it has no reference."""
    there = state["count"] > 0
    return tuple(np.where(there, value, np.nan).astype("<f4") for value in (state["mean"], variance_of_mean(state)))


def told_of(state):
    """What metadata keep: samples of a pixel, and how they were cut, so that the reference can go on."""
    count = state["count"]
    return {"samples": int(round(float(count.mean()))), "samples_least": int(count.min()), "samples_most": int(count.max()),
            "denominator_noise": denominator_noise(state["mean"], variance_of_mean(state)),
            "independent": True, "nonfinite": int(state["nonfinite"]), "seconds": float(state["seconds"])}

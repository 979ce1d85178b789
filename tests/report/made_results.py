"""A folder as `spool evaluate` writes it, with known figures, for tests of the report.

Errors are true_error * (1 + noise): which combinations differ and which do not is known.
"""

import csv

import numpy as np
from exr_writing import write_exr
from made_statistics import write_statistics

METRICS = ["mse", "mse_r", "rmse", "relmse", "relmse_trimmed", "relmse_dropped", "mae", "psnr_tm", "energy_ratio",
           "energy_ratio_d1"]
REST = ["efficiency", "samples_spent", "samples_initial", "saturated", "saturated_share", "seconds_sampling",
        "cpu_sampling", "seconds_filtering", "cpu_filtering", "seconds_reading", "seconds_per_sample", "seconds_total",
        "threads_used", "reference", "holdout", "width", "height", "relative_scale", "pixels_judged", "excluded_image",
        "excluded_reference", "guards", "error"]
HEADER = (["dump", "sampler", "filter", "spp", "replicate", "threads"] + [c for m in METRICS for c in (m, m + "_se")] + REST)

FACTOR = {"uniform": 1.0, "mitchell": 1.0, "multiscale": 0.7, "box": 1.0, "gaussian": 0.5, "directional": 0.25}


def make_rows(dumps=("scenes/chess.spool", "scenes/kitchen.spool"), samplers=("uniform", "mitchell", "multiscale"),
              filters=("box", "gaussian", "directional"), budgets=(4, 8, 16), replicates=5, noise=0.01, seed=1,
              size=(48, 40), factor=FACTOR):
    rng = np.random.default_rng(seed)
    rows = []
    for dump in dumps:
        for sampler in samplers:
            for spp in budgets:
                for replicate in range(replicates):
                    for filter_ in filters:
                        error = factor.get(sampler, 1.0) * factor.get(filter_, 1.0) / spp
                        error *= 1.0 + noise * rng.standard_normal()
                        rows.append(make_row(dump, sampler, filter_, spp, replicate, error, size))
    return rows


def make_row(dump, sampler, filter_, spp, replicate, error, size=(48, 40), **changes):
    energy = 0.97 if sampler == "multiscale" else 1.0 + 1e-4 * replicate
    values = {"mse": 0.5 * error, "mse_r": 0.4 * error, "rmse": max(error, 0.0) ** 0.5, "relmse": error,
              "relmse_trimmed": 0.9 * error, "relmse_dropped": 0.1 * error, "mae": 0.3 * error, "psnr_tm": 30.0 - error,
              "energy_ratio": energy, "energy_ratio_d1": energy}
    row = {name: "" for name in HEADER}
    for name, value in values.items():
        row[name], row[name + "_se"] = repr(value), repr(abs(value) * 0.02)
    pixels = size[0] * size[1]
    row.update(dump=dump, sampler=sampler, filter=filter_, spp=f"{spp:g}", replicate=str(replicate),
               samples_spent=str(pixels * spp), samples_initial=str(pixels * 2), saturated="3",
               saturated_share=repr(3 / pixels), seconds_sampling="0.01", cpu_sampling="0.02",
               seconds_filtering=repr(0.02 + 0.001 * replicate), cpu_filtering="0.03", seconds_reading="0.1",
               seconds_per_sample="1e-6", seconds_total=repr(0.03 + 0.001 * replicate + pixels * spp * 1e-5),
               efficiency=repr(1.0 / error) if error else "", threads="0", threads_used="2", reference="independent", holdout="0",
               width=str(size[0]), height=str(size[1]), relative_scale="1", pixels_judged=str(pixels),
               excluded_image="0", excluded_reference="0", guards="variance_floor=4 saturated_pieces=3")
    row.update(changes)
    return row


def write_results(folder, rows):
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "results.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, HEADER, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    write_statistics(folder, rows)


def scene(size):
    """[y][x][c]: a bright disc before a gradient, with one very bright pixel."""
    y, x = np.mgrid[0:size[1], 0:size[0]] / max(size)
    disc = ((x - 0.4) ** 2 + (y - 0.35) ** 2 < 0.06).astype(float)
    image = np.stack([0.2 + x + 2.0 * disc, 0.3 + 0.5 * y + 0.4 * disc, 0.6 - 0.4 * x + 0.1 * disc], axis=-1)
    image[2, 3] = 80.0
    return image


def write_images(folder, rows, names, file_name_of, seed=2):
    """Images of replicate 0 of every row; the reference once per recording."""
    rng = np.random.default_rng(seed)
    for row in rows:
        if row["replicate"] != "0":
            continue
        size = int(row["width"]), int(row["height"])
        truth = scene(size)
        name = names[row["dump"]]
        stem = folder / "_".join([name, file_name_of(row["sampler"]), file_name_of(row["filter"]),
                                  f"{float(row['spp']):g}spp"])
        spread = max(float(row["relmse"]), 1e-9) ** 0.5
        image = truth * (1.0 + spread * rng.standard_normal(truth.shape))
        write_exr(stem / "estimate.exr", planes(image))
        write_exr(stem / "squared_error.exr", {"Y": ((image - truth) ** 2).mean(2).astype("<f4")})
        write_exr(stem / "density.exr", {"n": rng.integers(1, 8 * int(float(row["spp"])), truth.shape[:2], "u4")})
        if row["filter"] == "directional":
            write_exr(stem / "filter_size.exr", {"level": rng.integers(0, 4, truth.shape[:2]).astype("<f4")})
            angle = np.where(truth[..., 0] > 1.5, np.nan, 180.0 * truth[..., 2] % 180.0)
            write_exr(stem / "direction.exr", {"angle": angle.astype("<f4")})
        write_exr(stem / "flip.exr", {"flip": np.clip(np.abs(image - truth).mean(2), 0, 1).astype("<f4")})
        write_exr(folder / f"{name}_reference.exr", planes(truth))


def planes(image):
    return {name: np.ascontiguousarray(image[..., c]).astype("<f4") for c, name in enumerate("RGB")}

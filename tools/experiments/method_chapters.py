"""Every sampler with every filter, and the comparison with the figures of independent prototypes."""
import math

from chapter import Chapter
from inference import mean_of, ratio_of
from tables import curves, finding, number, pool_title, table, with_interval

BASE = ("uniform", "box")


def milliseconds(values):
    """Mean over all replicates of the pools."""
    return f"{1000 * mean_of([v for one in values for v in one]).mean:.1f} ms"


def matrix(r, cell, corner):
    return table([corner, *r.filters], [[s, *(cell(s, f) for f in r.filters)] for s in r.samplers])


def over_recordings(r, column, method, spp):
    """Ratio to uniform + box, geometric mean over the recordings, of each plan's folder; of recordings measured one by one the
    mean of their logarithms is taken replicate by replicate."""
    found = r.overall(column, *method, spp)
    if found or len(r.pools) < 2:
        return found
    series = [(r.values(column, p, *method, spp), r.values(column, p, *BASE, spp)) for p in r.pools]
    if not all(a and len(a) == len(b) and min(*a, *b) > 0 for a, b in series):
        return []
    def middle(i):
        return [math.exp(sum(map(math.log, values)) / len(values)) for values in zip(*(pair[i] for pair in series))]
    return [ratio_of(middle(0), middle(1))]


def overview(m):
    r = m.results
    blocks = []
    for spp in r.budgets:
        def over_pools(s, f):
            found = over_recordings(r, "relmse", (s, f), spp)  # noqa: B023
            return "; ".join(map(with_interval, found)) if found else "–"
        blocks.append(f"relMSE relative to uniform with box at {spp:g} samples per pixel, geometric mean over the pools"
                      f"{' of each plan' if len(r.overall('relmse', *BASE, spp)) > 1 else ''}:\n\n"
                      + matrix(r, over_pools, "sampler \\ filter"))
    rows = []
    for pool in r.pools:
        for spp in r.budgets:
            real = [(m, v) for m, v in r.ranked("relmse", pool, spp) if m[0] != "neyman" and m[1] != "oracle_scale"]
            if not real:
                continue
            best = real[0][0]
            level = [" + ".join(m) for m, _ in real[1:] if r.order("relmse", pool, spp, best, m) == 0]
            rows.append([pool_title(pool), f"{spp:g}", " + ".join(best), with_interval(r.figure("relmse", pool, *best, spp)),
                         f"{r.figure('energy_ratio', pool, *best, spp).mean:.3f}",
                         ", ".join(level[:4]) + (f" and {len(level) - 4} more" if len(level) > 4 else "") or "none"])
    blocks.append("Best in relMSE without oracles, and what is not told apart from it (at most four named):\n\n"
                  + table(["pool", "spp", "best", "relMSE", "energy", "not told apart"], rows))
    ours = ("multiscale", "directional")
    said = [finding(f"multiscale + directional is below {s} + {f} in relMSE", r, ours, (s, f), "relmse")
            for s, f in (("uniform", "gaussian"), ("uniform", "directional"), ("greedy_error", "greedy_selection"),
                         ("nl_means", "nl_means"))]
    times = []
    for s in r.samplers:
        times.append([s, "", milliseconds(r.values("cpu_sampling", p, s, "box", 8) for p in r.pools)])
    for f in r.filters:
        times.append(["", f, milliseconds(r.values("cpu_filtering", p, "uniform", f, 8) for p in r.pools)])
    blocks += ["\n".join(said), "CPU time at 8 samples per pixel, mean over the pools (samplers without a "
               "filter in the loop):\n\n" + table(["sampler", "filter", "CPU"], times)]
    if r.failed:
        blocks.append("Refused: " + "; ".join(sorted({f"`{k[1]}` with `{k[2]}` ({e.split(':')[-1].strip()})"
                                                      for k, e in r.failed.items()})) + ".")
    return [*blocks, m.every_cell]


def all_cells(r):
    """The page of every cell."""
    titles = (("relmse", "relMSE"), ("mse", "MSE"), ("energy_ratio", "energy ratio"))
    lines = []
    for pool in r.pools:
        lines.append(f"## {pool_title(pool)[0].upper()}{pool_title(pool)[1:]}")
        for spp in r.budgets:
            for column, title in titles:
                lines.append(f"{title} at {spp:g} samples per pixel:\n\n" + matrix(
                    r, lambda s, f: with_interval(r.figure(column, pool, s, f, spp)), "sampler \\ filter"))  # noqa: B023
        lines.append("CPU milliseconds of sampling and filtering at 8 samples per pixel:\n\n" + matrix(
            r, lambda s, f: number(1000 * mean_of([a["cpu_sampling"] + a["cpu_filtering"] for a in r.rows(pool, s, f, 8)]).mean)  # noqa: B023
            if r.rows(pool, s, f, 8) else "–", "sampler \\ filter"))  # noqa: B023
    return lines


MULTI, OLD = "multiscale{init_spp=2}", ("directional{size_factor=literal_clamped,size_smooth=on,"
                                        "weighting=per_sample,base=none}")
RAW = ("greedy_error{init_spp=4,var_mode=raw}", "greedy_selection{var_mode=raw}")
QUIET, FLIES = "scene_s", "scene_s_fireflies"
# (pool, what, sampler, filter, figures of the prototype at 4, 8 and 16 spp, MSE relative to uniform with box)
FIGURES = [
    (QUIET, "multiscale, raw", MULTI, "box", (0.80, 0.75, 0.69)),
    (QUIET, "multiscale + directional, older rule", MULTI, OLD, (0.095, 0.115, 0.151)),
    (FLIES, "multiscale + directional, older rule", MULTI, OLD, (0.08, 0.08, 0.13)),
    (QUIET, "literal preset, raw", "multiscale:paper", "box", (1.23, 1.65, 1.47)),
    (QUIET, "literal preset + its directional", "multiscale:paper", "directional:paper", (1.11, 1.57, 1.51)),
    (QUIET, "mitchell, raw", "mitchell{init_spp=2}", "box", (0.93, 1.08, 1.59)),
    (QUIET, "AWR, raw", "adaptive_wavelet{init_spp=2}", "box", (1.75, 2.25, 1.66)),
    (QUIET, "AWR + shrinkage", "adaptive_wavelet{init_spp=2}", "wavelet_shrinkage", (0.52, 0.72, 0.57)),
    (QUIET, "uniform + shrinkage", "uniform", "wavelet_shrinkage", (0.30, 0.34, 0.39)),
    (QUIET, "uniform + GEM selection", "uniform", "greedy_selection{var_mode=raw}", (0.10, 0.13, 0.18)),
    (QUIET, "GEM, 4 initial, raw", RAW[0], "box", (None, 1.01, 0.87)),
    (QUIET, "GEM, 4 initial, + selection", *RAW, (None, 0.125, 0.143)),
    (FLIES, "GEM + selection", *RAW, (None, 0.07, 0.10)),
    (QUIET, "GEM, 2 initial, + selection", "greedy_error{init_spp=2,var_mode=raw}", RAW[1], (None, 0.262, 0.226)),
]


def prototypes(m):
    r = m.results
    rows = []
    for pool, what, sampler, filter_name, figures in FIGURES:
        row = [pool_title(pool), what]
        for spp, figure in zip((4, 8, 16), figures):
            found = with_interval(r.ratio("mse", pool, spp, (sampler, filter_name), BASE))
            row.append(found + (f" ({figure:g})" if figure and found != "–" else ""))
        rows.append(row)
    return ["MSE relative to uniform with box; the prototype's figure in brackets:\n\n"
            + table(["pool", "method", "4 spp", "8 spp", "16 spp"], rows)]


def features(m):
    r = m.results
    blocks = [curves(r, pool, "relmse") for pool in r.pools]
    said = []
    for filter_name in ("gaussian", "nl_means", "directional"):
        for sampler in ("uniform", "multiscale"):
            said.append(finding(f"cross_bilateral is below {filter_name} in relMSE, {sampler} samples", r,
                                (sampler, "cross_bilateral"), (sampler, filter_name), "relmse"))
    for sampler in ("uniform", "multiscale", "nl_means"):
        said.append(finding(f"sampling by the risk of cross_bilateral is below {sampler} in relMSE, both filtered by it", r,
                            ("cross_bilateral", "cross_bilateral"), (sampler, "cross_bilateral"), "relmse"))
    return [*blocks, "\n".join(said)]


CHAPTERS = [
    Chapter("methods", "Every sampler with every filter", ["methods"],
            "Sampling and reconstruction are separate stages here: any sampler runs with any filter.", overview,
            optional=("methods_more",)),
    Chapter("features", "Methods with recorded features", ["features"],
            "Normal, albedo and depth are nearly free of noise: what do they add to a filter, and to where samples go? "
            "[LiWuChuang12]", features),
    Chapter("prototypes", "The figures of independent prototypes", ["prototypes"],
            "Prototypes in numpy, written before this program, gave figures on scene S (64 x 64, their own noise, mean of "
            "three seeds). Here the same settings are run: two initial samples, the older size rule, raw variances.",
            prototypes),
]

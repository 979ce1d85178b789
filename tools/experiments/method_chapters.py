"""Every sampler with every filter, and the comparison with the figures of independent prototypes."""
import math

from chapter import Chapter
from results import mean, order, ratio
from tables import curves, finding, mean_text, number, pool_title, ratio_text, table, with_error

BASE = ("uniform", "box")


def geometric(r, sampler, filter_name, spp, column):
    """Geometric mean over pools of the ratio to uniform with box, with its standard error."""
    logs, variance = [], 0.0
    for pool in r.pools:
        found = ratio(r.values(column, pool, sampler, filter_name, spp), r.values(column, pool, *BASE, spp))
        if not found or found[0] <= 0:
            return None
        logs.append(math.log(found[0]))
        variance += (found[1] / found[0]) ** 2
    middle = math.exp(mean(logs))
    return middle, middle * math.sqrt(variance) / len(logs)


def matrix(r, cell, corner):
    return table([corner, *r.filters], [[s, *(cell(s, f) for f in r.filters)] for s in r.samplers])


def overview(m):
    r = m.results
    blocks = []
    for spp in r.budgets:
        found = {(s, f): geometric(r, s, f, spp, "relmse") for s in r.samplers for f in r.filters}
        blocks.append(f"relMSE relative to uniform with box at {spp:g} samples per pixel, geometric mean over "
                      f"{len(r.pools)} pools:\n\n"
                      + matrix(r, lambda s, f: with_error(*found[s, f]) if found[s, f] else "–", "sampler \\ filter"))  # noqa: B023
    rows = []
    real = [(s, f) for s in r.samplers for f in r.filters if s != "neyman" and f != "oracle_scale"]
    for pool in r.pools:
        for spp in r.budgets:
            values = {c: r.values("relmse", pool, *c, spp) for c in real}
            best = min((c for c in real if values[c]), key=lambda c: mean(values[c]))
            level = [f"{s} + {f}" for s, f in real
                     if (s, f) != best and values[s, f] and order(values[best], values[s, f]) == 0]
            rows.append([pool_title(pool), f"{spp:g}", " + ".join(best), mean_text(values[best]),
                         f"{r and mean(r.values('energy_ratio', pool, *best, spp)):.3f}", ", ".join(level[:4]) or "none"])
    blocks.append("Best in relMSE without oracles, and what is level with it within the noise (at most four shown):\n\n"
                  + table(["pool", "spp", "best", "relMSE", "energy", "level"], rows))
    ours = ("multiscale", "directional")
    said = [finding(f"multiscale + directional is below {s} + {f} in relMSE", r, ours, (s, f), "relmse")
            for s, f in (("uniform", "gaussian"), ("uniform", "directional"), ("greedy_error", "greedy_selection"),
                         ("nl_means", "nl_means"))]
    times = []
    for s in r.samplers:
        cpu = [1000 * mean(r.values("cpu_sampling", p, s, "box", 8)) for p in r.pools]
        times.append([s, "", f"{mean(cpu):.1f} ms"])
    for f in r.filters:
        cpu = [1000 * mean(r.values("cpu_filtering", p, "uniform", f, 8)) for p in r.pools]
        times.append(["", f, f"{mean(cpu):.1f} ms"])
    blocks += ["\n".join(said), "CPU time at 8 samples per pixel, 64 x 64 pixels, mean over the pools (samplers without a "
               "filter in the loop):\n\n" + table(["sampler", "filter", "CPU"], times)]
    if r.failed:
        blocks.append("Refused: " + "; ".join(sorted({f"`{k[1]}` with `{k[2]}` ({e.split(':')[-1].strip()})"
                                                      for k, e in r.failed.items()})) + ".")
    blocks.append("Every cell with its standard error, as MSE, relMSE and energy ratio at each budget, and time: "
                  "[experiments_methods.md](experiments_methods.md).")
    return blocks


def all_cells(r):
    """The page of every cell."""
    titles = (("relmse", "relMSE"), ("mse", "MSE"), ("energy_ratio", "energy ratio"))
    lines = []
    for pool in r.pools:
        lines.append(f"## {pool_title(pool)[0].upper()}{pool_title(pool)[1:]}")
        for spp in r.budgets:
            for column, title in titles:
                lines.append(f"{title} at {spp:g} samples per pixel:\n\n" + matrix(
                    r, lambda s, f: mean_text(r.values(column, pool, s, f, spp)), "sampler \\ filter"))  # noqa: B023
        lines.append("CPU milliseconds of sampling and filtering at 8 samples per pixel:\n\n" + matrix(
            r, lambda s, f: number(1000 * mean([a["cpu_sampling"] + a["cpu_filtering"] for a in r.rows(pool, s, f, 8)]))  # noqa: B023
            if r.rows(pool, s, f, 8) else "–", "sampler \\ filter"))  # noqa: B023
    return lines


MULTI, OLD = "multiscale{init_spp=2}", ("directional{size_factor=literal_clamped,size_smooth=on,"
                                        "weighting=per_sample,base=none}")
RAW = ("greedy_error{gem_init=4,var_mode=raw}", "greedy_selection{var_mode=raw}")
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
    (QUIET, "GEM, 2 initial, + selection", "greedy_error{gem_init=2,var_mode=raw}", RAW[1], (None, 0.262, 0.226)),
]


def prototypes(m):
    r = m.results
    rows = []
    for pool, what, sampler, filter_name, figures in FIGURES:
        row = [pool_title(pool), what]
        for spp, figure in zip((4, 8, 16), figures):
            found = ratio(r.values("mse", pool, sampler, filter_name, spp), r.values("mse", pool, *BASE, spp))
            row.append("–" if not found else f"{with_error(*found)}" + (f" ({figure:g})" if figure else ""))
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

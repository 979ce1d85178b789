"""E1 to E11: the paper's table and figures on the pools of the tree."""
from chapter import Chapter
from density_chapters import MULTISCALE, borders, density, pyramid_filters, threshold
from fresh_tables import biases, fresh, fresh_ratios
from inference import ratio_of
from measured import hardware_threads
from results import options
from statements import FRESH
from tables import curves, finding, mean_text, pool_title, table, with_interval


def filters_over_budget(m):
    r = m.results
    said = []
    for preset in ("", ":paper"):
        shown = preset[1:] or "robust"
        five = (options(MULTISCALE + preset, "filter=5-3"), "box")
        # Below 4 samples `robust` has taken two everywhere and decided nothing.
        budgets = [b for b in r.budgets if b > 2 or preset]
        said += [finding(f"{shown}: 5-3 is below {name} in MSE", r, five,
                         (options(MULTISCALE + preset, f"filter={name}"), "box"), budgets=budgets)
                 for name in ("haar", "9-7", "db3")]
        below_uniform = f"{shown}: 5-3 is below uniform sampling in MSE"
        said.append(finding(below_uniform, r, five, ("uniform", "box"), budgets=budgets))
        said.append(finding(below_uniform + FRESH, r, five, ("uniform", "box"), "mse_fresh", budgets=budgets))
    return [*(curves(r, pool) for pool in r.pools), fresh(r, 8, [(s, "box") for s in r.samplers]), "\n".join(said)]


def samplers_over_budget(m):
    r = m.results
    budgets = [b for b in r.budgets if b > 2]
    ours, uniform = (MULTISCALE, "box"), ("uniform", "box")
    said = [finding(f"{who} is below uniform in MSE{where}", r, method, uniform, column, budgets=budgets)
            for who, method in (("multiscale", ours), ("the preset paper", ("multiscale:paper", "box")))
            for where, column in (("", "mse"), (FRESH, "mse_fresh"))]
    said.append(finding(f"multiscale is below uniform in relMSE{FRESH}", r, ours, uniform, "relmse_fresh", budgets=budgets))
    said += [finding(f"multiscale is below {name} in MSE{where}", r, ours, (name, "box"), column, budgets=budgets)
             for name in ("mitchell", "adaptive_wavelet", "greedy_error") for where, column in (("", "mse"), (FRESH, "mse_fresh"))]
    said.append(finding("multiscale is below the control that only clamps uniform samples in relMSE", r, ours,
                        ("uniform", "clamped"), "relmse", budgets=budgets))
    said.append(finding("mitchell is below uniform in relMSE", r, ("mitchell", "box"), uniform, "relmse", budgets=budgets))
    # neyman minimises the error of means that did not decide on their counts; on fresh samples it knows the deviations of the deciding half only.
    said += [finding(text, r, ours, ("neyman{minimise=mse}", "box"), column, budgets=budgets)
             for text, column in (("multiscale is below the oracle neyman in MSE", "mse"),
                                  (f"multiscale is below neyman with the deviations of the deciding half in MSE{FRESH}", "mse_fresh"))]
    said.append(as_uniform(r, "mitchell", budgets))
    energy = [[pool_title(pool), *(with_interval(r.figure("energy_ratio", pool, s, "box", 8)) for s in r.samplers)]
              for pool in r.pools]
    return [*(curves(r, pool, column) for pool in r.pools for column in ("mse", "relmse")),
            "Energy ratio at 8 samples per pixel (below 1: bright events that were missed are not looked for again):\n\n"
            + table(["pool", *r.samplers], energy), fresh(r, 8, [(s, "box") for s in r.samplers]), fresh_ratios(r, 8), "\n".join(said)]


AS_UNIFORM = 0.01


def as_uniform(r, sampler, budgets, threads=None):
    """Where a sampler gave the error of uniform sampling: what is said against it there is said against that."""
    found = []
    for pool in r.pools:
        pairs = {b: [r.values("mse", pool, s, "box", b, threads) for s in (sampler, "uniform")] for b in budgets}
        same = [f"{b:g}" for b, (own, even) in pairs.items() if own and even and abs(ratio_of(own, even).mean - 1) < AS_UNIFORM]
        found += [f"{pool_title(pool)} at {', '.join(same)} spp"] if same else []
    return (f"- {sampler} samples all but uniformly (its MSE without a filter is within {100 * AS_UNIFORM:.0f} % of that of uniform samples): "
            f"{'; '.join(found)}." if found else "")


def directions(m):
    r = m.results
    iso, bank = options("directional", "anisotropy=none"), options("directional", "anisotropy=bank,bank_levels=3")
    raw = (MULTISCALE, "box")
    said = [finding("the directional filter lowers the MSE of adaptive sampling", r, (MULTISCALE, bank), raw),
            finding("three stages of the bank are below the isotropic filter", r, (MULTISCALE, bank), (MULTISCALE, iso)),
            finding("three stages of the bank are below the isotropic filter in relMSE", r, (MULTISCALE, bank), (MULTISCALE, iso), "relmse"),
            finding("three stages are below two", r, (MULTISCALE, bank), (MULTISCALE, options("directional", "anisotropy=bank,bank_levels=2"))),
            finding("the preset paper with its filter is below uniform with box", r,
                    ("multiscale:paper", "directional:paper"), ("uniform", "box"))]
    for text, setting in (("with S the variance of the coarse mean", "size_factor=literal,size_variance=coarse_var"),
                          ("with the reciprocal factor", "size_factor=inverse"),
                          ("with both", "size_factor=inverse,size_variance=coarse_var")):
        reading = ("multiscale:paper", options("directional:paper", setting))
        if reading[1] in r.filters:
            said.append(finding(f"the preset paper {text} is below uniform with box", r, reading, ("uniform", "box")))
            said.append(finding(f"the preset paper {text} is below the preset as it is", r, reading, ("multiscale:paper", "directional:paper")))
    return [*(curves(r, pool) for pool in r.pools), "\n".join(said)]


def threads(m):
    r = m.results
    seconds, faster = [], []
    for sampler in r.samplers:
        wall = {count: [a["seconds_sampling"] + a["seconds_filtering"] for a in r.rows(r.pools[0], sampler, "directional", 4, count)] for count in r.threads}
        seconds.append([sampler, *(mean_text(w) if w else "–" for w in wall.values())])
        faster.append([sampler, *(with_interval(ratio_of(wall[r.threads[0]], w)) if w else "–" for w in wall.values())])
    same = all(len({tuple(r.values("mse", r.pools[0], s, "directional", 4, t)) for t in r.threads}) == 1 for s in r.samplers)
    cost = r.rows(r.pools[0], r.samplers[0], "directional", 4)[0].get("seconds_per_sample")
    at_once = hardware_threads(r.folders[0])
    counts = [f"{t:g}" for t in r.threads]
    return ["Sampling and filtering, seconds:\n\n" + table(["number of threads", *counts], seconds),
            "How many times faster than with one thread:\n\n" + table(["with threads", *counts], faster),
            f"- MSE is the same bits for every number of threads: {'yes' if same else '**no**'}.\n"
            + (f"- 2 to 4 times faster on 8 threads: not tested; at most {counts[-1]} threads were run"
               f"{f', on a machine that runs {at_once} at a time' if at_once else ''}.\n" if max(r.threads) < 8 else "")
            + "- Times are those of one machine, which may have had other work; beyond the number of its cores nothing can be gained. "
            + ("The scene is analytic, so there is no cost of rendering to add." if not cost else "")]


CONSIDERABLE = 1.1  # the paper names no number: a tenth more error


def tiles(m):
    r = m.results
    ours = lambda tile: options(MULTISCALE, f"parallel=tiles,tile={tile}")  # noqa: E731
    printed = lambda tile: options("multiscale:paper", f"tile={tile}")  # noqa: E731
    same = all(r.values("mse", p, s, f, b, 1) == r.values("mse", p, s, f, b, 8)
               for p in r.pools for s in r.samplers for f in r.filters for b in r.budgets)
    blocks, said = [], [f"- 1 and 8 threads give the same bits: {'yes' if same else '**no**'}."]
    presets = [(shown, name) for shown, name in (("robust", ours), ("paper", printed)) if name(64) in r.samplers]
    worst = {shown: [] for shown, _ in presets}
    for pool in r.pools:
        rows = []
        for shown, name in presets:
            ratios = {(tile, f): [r.ratio("mse", pool, b, (name(tile), f), (name(0), f)) for b in r.budgets] for tile in (64, 16) for f in ("box", "directional")}
            rows += [[f"{shown}, tiles of {tile}, {f}", *map(with_interval, found)] for (tile, f), found in ratios.items()]
            for f in ("box", "directional"):
                high = max(found.mean for (_, g), all_found in ratios.items() if g == f for found in all_found)
                worst[shown].append((f"{pool_title(pool)}, {f}", high, high < CONSIDERABLE))
        blocks.append(f"{pool_title(pool)}, MSE over that without tiles:\n\n" + table(["with at a budget of", *(f"{b:g}" for b in r.budgets)], rows))
    said += [threshold(f"preset {shown}: tiles raise the MSE by less than {100 * (CONSIDERABLE - 1):.0f} % (largest ratio)", found) for shown, found in worst.items()]
    return [*blocks, "\n".join(said)]


# Each sampler with its own filter.
RIVALS = (("uniform", "box"), ("mitchell", "multistage"), ("adaptive_wavelet", "wavelet_shrinkage"),
          ("greedy_error", "greedy_selection"), ("nl_means", "nl_means"))
EPOCHS, EXACT = ((options(MULTISCALE, f"update={update}"), "directional") for update in ("epoch", "exact"))
ROBUST, PRINTED = (MULTISCALE, "directional"), ("multiscale:paper", "directional:paper")
COARSE, INVERSE = (("multiscale:paper", options("directional:paper", reading)) for reading in ("size_variance=coarse_var", "size_factor=inverse"))
OWN = (*RIVALS, EPOCHS, EXACT, (options(MULTISCALE, "parallel=tiles,tile=32"), "directional"), PRINTED, COARSE, INVERSE)


def against_rivals(r, ours, metrics, where="", budgets=None, column="{}"):
    """ours: the method with our preset."""
    return [finding(f"{who} is below {s} + {f} in {c}{where}", r, method, (s, f), column.format(c.lower()), budgets=budgets)
            for who, method in (("multiscale + directional", ours), ("the preset paper", PRINTED)) for s, f in RIVALS for c in metrics]


def behind_the_same_filter(r, ours, budgets=None, where="", column="{}"):
    """What the sampler adds to its filter, and whether uniform samples with the strongest filter of the rivals do as well."""
    return [finding(f"{who} is below {name} in {c}{where}", r, method, ("uniform", f), column.format(c.lower()), budgets=budgets)
            for who, method, name, f in (("multiscale + directional", ours, "uniform + directional", "directional"),
                                         ("the preset paper", PRINTED, "uniform samples behind its own filter", "directional:paper"),
                                         ("multiscale + directional", ours, "uniform + nl_means", "nl_means")) for c in ("MSE", "relMSE")]


def every_method(m):
    r = m.results
    said = against_rivals(r, EPOCHS, ("MSE", "relMSE")) + against_rivals(r, EPOCHS, ("MSE", "relMSE"), FRESH, column="{}_fresh")
    said += behind_the_same_filter(r, EPOCHS) + behind_the_same_filter(r, EPOCHS, where=FRESH, column="{}_fresh")
    said += [finding(f"the preset paper with {text} is below the preset as it is in relMSE", r, reading, PRINTED, "relmse")
             for text, reading in (("S the variance of the coarse mean", COARSE), ("the reciprocal factor", INVERSE)) if reading[1] in r.filters]
    said += [finding("one region a step is below many in MSE", r, EXACT, EPOCHS), as_uniform(r, "mitchell", r.budgets)]
    return [*(own_filters(r, pool) for pool in r.pools), fresh(r, 8, OWN, "every method with its own filter"), at_equal_energy(r, 8),
            *biases(r, 8, (*RIVALS, EPOCHS, PRINTED, COARSE)), "\n".join(filter(None, said))]


def at_equal_energy(r, spp):
    """Short enough to be read on the page."""
    rows = [[" + ".join(method), *(with_interval(r.figure("relmse_equal_energy", pool, *method, spp)) for pool in r.pools)]
            for method in (*RIVALS, EPOCHS, PRINTED)]
    return (f"relMSE at {spp} samples per pixel when each image is scaled to the light of the reference (light that is lost in few places does not come back by that):\n\n"
            + table(["method", *map(pool_title, r.pools)], rows))


def own_filters(r, pool):
    """Every sampler with its own filter on one recording."""
    rows = []
    for sampler, filter_name in OWN:
        cell = (pool, sampler, filter_name, 8)
        time = [a["cpu_sampling"] + a["cpu_filtering"] for a in r.rows(*cell)]
        if time:
            rows.append([f"{sampler} + {filter_name}",
                         *(with_interval(r.figure(c, *cell)) for c in ("mse", "relmse", "relmse_equal_energy", "flip_ldr", "ssim", "energy_ratio")),
                         f"{mean_text([1000 * t for t in time])} ms"])
    return (f"{pool_title(pool)} at 8 samples per pixel:\n\n"
            + table(["method", "MSE", "relMSE", "relMSE at equal energy", "FLIP", "SSIM", "energy ratio", "CPU time"], rows))


def over_budget(m):
    """Every sampler with its own filter."""
    r = m.results
    budgets = [b for b in r.budgets if b > 2]  # at 2 samples none has decided anything
    said = against_rivals(r, ROBUST, ("relMSE",), " at 4 samples per pixel and more", budgets) + behind_the_same_filter(r, ROBUST, budgets)
    return [*(curves(r, pool, column, methods=(*RIVALS, ROBUST, PRINTED)) for pool in r.pools for column in ("mse", "relmse")), "\n".join(said)]


RAW = "The paper's scenes are not public; recordings of the tree and scene S stand in for them."
CHAPTERS = [
    Chapter("E1", "Table 1, Figure 7: which levels are sampled", ["e1_pyramid_filters"],
            "Samples by level for four wavelets: 5-3 puts more samples into large regions, DB3 is rough with many of them.",
            pyramid_filters, density=True, apart=RAW),
    Chapter("E2", "Figure 8a: error over budget by wavelet", ["e2_filters_over_budget"],
            "5-3 has the lowest error of the unfiltered estimate.", filters_over_budget, apart=RAW),
    Chapter("E3", "Figure 8b: error over budget by sampler", ["e3_samplers_over_budget"],
            "The multi-scale sampler has the lowest error of the unfiltered estimate. (Greedy error minimisation samples "
            "for a filtered result: alone it is judged unfairly, see E9.)", samplers_over_budget, apart=RAW
            + " `mitchell` and `adaptive_wavelet` are re-implemented from published descriptions.", stand_in="methods"),
    Chapter("E4", "Figures 8c and 10: the directional filter", ["e4_directions"],
            "Filtering with directions lowers the error further than sampling alone.", directions, apart=RAW),
    Chapter("E5", "Figure 9: density of every sampler", ["e5_density"],
            "Multi-scale: edges and soft regions; Mitchell: edges alone; greedy: soft regions; wavelets: dyadic blocks.",
            density, density=True, apart=RAW),
    Chapter("E6", "Figure 11a: time over threads", ["e6_threads"], "2 to 4 times faster on 8 threads.", threads,
            apart_at_full="Here 1, 2 and 4 threads. A replay traces no rays. The paper's times hold rendering, which scales by itself.",
            apart="A replay traces no rays. The paper's times hold rendering, which scales by itself."),
    Chapter("E7", "Figure 11b: error over tiles", ["e7_tiles"], "Tiles do not considerably affect the error.", tiles,
            apart="128 x 128 pixels: tiles of 128 are the whole image and are left out.",
            apart_at_full="512 x 512 pixels, 64 samples."),
    Chapter("E8", "Figures 11c-f: borders of tiles", ["e8_tile_borders"],
            "The density shows the tiles.", borders,
            density=True),
    Chapter("E9", "Figure 12, top: chess, every method with its filter", ["e9_chess"],
            "The multi-scale method has the lowest error and the fewest artefacts.", every_method, apart=RAW),
    Chapter("E10", "Figure 12, bottom: balls, every method with its filter", ["e10_balls"],
            "As E9; adaptive_wavelet shows blocks or ringing, Mitchell noise in shadows and highlights.", every_method, apart=RAW),
    Chapter("E11", "Figure 12, curves: error over budget, every method with its filter", ["e11_error_over_budget"],
            "The multi-scale method has the lowest error at every budget.", over_budget, apart=RAW),
]

"""The first tables: the two samplers and three filters that the program started with."""
from chapter import Chapter
from results import mean, order
from tables import mean_text, pool_title, ratio_text, table

ROWS = [("uniform", "box"), ("uniform", "gaussian"), ("uniform", "directional"), ("multiscale", "box"),
        ("multiscale", "gaussian"), ("multiscale", "directional"), ("multiscale:paper", "box"),
        ("multiscale:paper", "directional:paper")]
BASE = ("uniform", "box")


def first(m):
    r = m.results
    blocks = []
    for pool in ("scene_s", "chess"):
        rows = []
        for spp in r.budgets:
            for method in ROWS:
                cell, base = (pool, *method, spp), (pool, *BASE, spp)
                rows.append([f"{spp:g}", *method, *(text for c in ("mse", "relmse") for text in
                                                   (mean_text(r.values(c, *cell)),
                                                    ratio_text(r.values(c, *cell), r.values(c, *base)))),
                             mean_text(r.values("energy_ratio", *cell))])
        blocks.append(f"### {pool_title(pool)[0].upper()}{pool_title(pool)[1:]}\n\n" + table(
            ["spp", "sampler", "filter", "MSE", "ratio", "relMSE", "ratio", "energy"], rows))
    return blocks + ["\n".join(remarks(r))]


def remarks(r):
    said = []
    for pool in ("scene_s", "chess"):
        literal = [order(r.values("mse", pool, "multiscale:paper", "box", b), r.values("mse", pool, *BASE, b)) for b in r.budgets]
        said.append(f"- {pool_title(pool)}: the literal preset without a filter is above uniform sampling in MSE at "
                    f"{literal.count(1)} of {len(literal)} budgets, below at {literal.count(-1)}.")
    energy = [f"{100 * (1 - mean(r.values('energy_ratio', 'chess', 'multiscale', 'directional', b))):.0f}" for b in r.budgets]
    gain = [ratio_text(r.values("relmse", "chess", "multiscale", "directional", b),
                       r.values("relmse", "chess", "uniform", "gaussian", b)) for b in r.budgets]
    said.append(f"- chess: multiscale + directional has {', '.join(gain)} of the relMSE of uniform + gaussian, and loses "
                f"{', '.join(energy)} % of the energy, most of it in the small bulbs behind the board: few samples often miss "
                "a bulb, and what looks dark is not looked at again.")
    said.append("- Several equations are missing from the printed text. That the literal preset loses says that the text is "
                "not sufficient, not that its authors' program failed.")
    return said


CHAPTERS = [Chapter("first", "Two samplers, three filters", ["methods"],
                    "What does the method gain over uniform samples and a Gaussian, with its defaults and as printed?", first)]

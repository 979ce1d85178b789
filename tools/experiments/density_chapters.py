"""E1, E5 and E8: where samplers put their samples."""
import math

from inference import mean_of, order_of
from results import options
from tables import mean_text, pool_title, table, with_interval

MULTISCALE = "multiscale"
FILTERS = ("haar", "5-3", "9-7", "db3")
RIVAL_SAMPLERS = ("mitchell", "adaptive_wavelet", "greedy_error", "nl_means")
UNITS = ("Shares of the preset `paper` depend on the unit of radiance, because eq 5 adds |d|² to a contrast, which has no unit. "
         "The unit of the published scenes is not known, so Table 1 can be compared in its order, not in its numbers. The preset `paper` works in "
         "tiles of 64 pixels, each with its share of the budget: a picture of 64 x 64 pixels is one tile, a larger one shows their borders.")


def pyramid_filters(m):
    blocks, columns = [], [f"level_{k}" for k in range(1, 5)]
    for pool in dict.fromkeys(key[0] for key in m.density):
        rows = []
        for preset in ("", ":paper"):
            for name in FILTERS:
                found = m.density.get((pool, options(MULTISCALE + preset, f"filter={name}"), 4))
                if found:
                    rows.append([f"{'paper' if preset else 'robust'}, {name}",
                                 *(mean_text(found.get(c, [])) for c in columns),
                                 mean_text(found.get("near_edges", []))])
        area = next(v["edge_area"][0] for k, v in m.density.items() if k[0] == pool)
        blocks.append(f"{pool_title(pool)}, share of the samples of each level of the priority queue at 4 samples per pixel, and of "
                      f"the adaptive samples near edges (these are {100 * area:.0f} % of the image):\n\n"
                      + table(["preset, filter", "level 1", "2", "3", "4", "near edges"], rows))
    said = []
    more = "5-3 puts more samples into the largest regions (levels 3 and 4) than"
    for statement, high, low in ((f"{more} Haar", "5-3", "haar"), (f"{more} 9-7", "5-3", "9-7"),
                                 ("DB3 puts more samples into them than 5-3", "db3", "5-3")):
        verdicts = []
        for pool in dict.fromkeys(key[0] for key in m.density):
            for preset in ("", ":paper"):
                key = lambda f: (pool, options(MULTISCALE + preset, f"filter={f}"), 4)  # noqa: E731
                found = order_of(*(m.density.get(key(f), {}).get("levels_3_4", []) for f in (low, high)))
                if found is not None:
                    word = {-1: "yes", 0: "not told apart", 1: "**no**"}[found]
                    verdicts.append(f"{pool_title(pool)}, {preset[1:] or 'robust'}: {word}")
        said.append(f"- {statement}: {'; '.join(verdicts)}.")
    return blocks + ["\n".join(said), UNITS]


def density(m):
    blocks, said = [], []
    for pool in dict.fromkeys(key[0] for key in m.density):
        found = {sampler: measures for (p, sampler, _), measures in m.density.items() if p == pool}
        rows = [[sampler, with_interval(mean_of(measures.get("correlation", []), positive=False)),  # which may be below 0
                 *(mean_text(measures.get(c, [])) for c in ("block_index", "near_edges"))]
                for sampler, measures in found.items()]
        area = next(iter(found.values()))["edge_area"][0]
        blocks.append(f"{pool_title(pool)} at 16 samples per pixel; edges are {100 * area:.0f} % of the image:\n\n"
                      + table(["sampler", "correlation of the count with the pool's deviation", "block artefact index (16 pixels)",
                               "adaptive samples near edges"], rows))

        def mean(sampler, measure):
            return mean_of(found[sampler].get(measure, [])).mean  # not a number where all pixels have as many samples

        index, ours = (mean(s, "block_index") for s in ("adaptive_wavelet", MULTISCALE))
        rivals = [mean(s, "correlation") for s in RIVAL_SAMPLERS]
        # Where edges are over a third of the image no sampler can fall on them much more often.
        said.append((pool_title(pool), index, ours, mean("mitchell", "near_edges") / area if area <= 1 / 3 else math.nan,
                     mean(MULTISCALE, "correlation") - max((r for r in rivals if r == r), default=0.0)))
    return [*blocks, "\n".join([
        threshold("the samples of adaptive_wavelet lie in dyadic blocks (index above 1.5)", [(p, a, a > 1.5) for p, a, *_ in said]),
        threshold("multiscale shows no blocks (index below 1.2)", [(p, b, b < 1.2) for p, _, b, *_ in said]),
        threshold("mitchell samples edges (twice as often as uniform samples fall on them)", [(p, e, e > 2) for p, _, _, e, _ in said if e == e]),
        threshold(f"the counts of multiscale follow the noise more closely than those of {', '.join(RIVAL_SAMPLERS)} "
                  "(difference of the correlations above 0)", [(p, d, d > 0) for p, *_, d in said])]),
        "The deviation is that of the whole pool, and the samples that decide on the counts are a part of it: the correlation is a little higher than it "
        "would be with samples held out."]


def threshold(statement, found):
    """A line as those of tables.finding; found: [(recording, value, whether it holds)]."""
    held = sum(holds for _, _, holds in found)
    verdict = "agrees" if held == len(found) else "**mixed**" if held else "**disagrees**"
    return f"- {statement}: {verdict}. " + ". ".join(f"{pool}: {value:.2f}" for pool, value, _ in found) + "."


SHOWS_TILES = 1.2


def borders(m):
    rows, jumps = [], {}
    several = len({key[0] for key in m.density}) > 1
    for (pool, sampler, _), found in m.density.items():
        rows.append([f"{pool_title(pool)}, {sampler}" if several else sampler, mean_text(found.get("tile_jump", [])),
                     mean_text(found.get("block_index", []))])
        if jump := found.get("tile_jump"):
            jumps.setdefault(f"{pool_title(pool)}, {'paper' if ':paper' in sampler else 'robust'}", []).append(mean_of(jump).mean)
    said = threshold(f"the density shows the tiles (jump at their borders above {SHOWS_TILES:g})",
                     [(name, min(found), min(found) > SHOWS_TILES) for name, found in jumps.items()])
    return ["Mean jump of the count across borders, relative to jumps elsewhere:\n\n"
            + table(["sampler", "at its tiles", "at multiples of 16"], rows), said]

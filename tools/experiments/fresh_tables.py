"""Tables of the columns that `fresh = true` adds: errors on fresh samples, bias squared and variance."""
from density_chapters import MULTISCALE
from inference import ratio_of
from statements import FRESH
from tables import mean_text, pool_title, table, with_interval

COLUMNS = {"MSE": "mse", "MSE, fresh": "mse_fresh", "bias²": "mse_bias2", "variance": "mse_variance", "relMSE": "relmse",
           "relMSE, fresh": "relmse_fresh", "energy": "energy_ratio", "energy, fresh": "energy_fresh"}


def fresh(r, budget, methods, of="no filter"):
    """What the distribution of the samples is worth: the same counts on samples that had no say in them."""
    if not any(r.values("mse_fresh", pool, *method, budget) for pool in r.pools for method in methods):
        return ""
    rows = [[pool_title(pool), sampler if of == "no filter" else f"{sampler} + {filter_name}",
             *(mean_text(r.values(c, pool, sampler, filter_name, budget)) for c in COLUMNS.values())]
            for pool in r.pools for sampler, filter_name in methods if r.rows(pool, sampler, filter_name, budget)]
    return (f"Counts decided on one half of each pixel's samples and applied to the other, at {budget} samples per pixel, {of}. "
            "Where the fresh error is above the own one, the gain came from samples that decided and were judged, not from a better "
            "distribution. `neyman` takes deviations from the half that decides: where that half has missed rare bright samples, another "
            "sampler can have the lower fresh error:\n\n" + table(["pool", "sampler" if of == "no filter" else "method", *COLUMNS], rows))


def fresh_ratios(r, budget):
    """Short enough to be read on the page: methods by recordings."""
    rows = []
    for name, sampler in (("multiscale", MULTISCALE), ("preset paper", "multiscale:paper")):
        for shown, column in (("MSE", "mse"), ("relMSE", "relmse")):
            for kind, c in ((" on its own samples", column), (FRESH, column + "_fresh")):
                found = [ratio_of(*(r.values(c, pool, s, "box", budget) for s in (sampler, "uniform"))) for pool in r.pools]
                rows.append([f"{name}, {shown}{kind}", *map(with_interval, found)])
    return (f"Errors at {budget} samples per pixel without a filter, relative to uniform sampling. A sampler that is "
            "below 1 on its own samples alone gains by the choice of samples, not by where they lie: a bright one calls for more, which dilute it, "
            "and where no light was seen none follow:\n\n"
            + table(["error", *map(pool_title, r.pools)], rows))


def biases(r, budget, methods):
    """Blocks: methods by recordings: how much of the MSE more runs would not average away, and its share of the MSE."""
    pools = [p for p in r.pools if any(r.values("mse_bias2", p, *method, budget) for method in methods)]
    if not pools:
        return []
    sizes, shares = [], []
    for method in methods:
        found = [[r.values(c, pool, *method, budget) for c in ("mse_bias2", "mse_variance")] for pool in pools]
        # An estimate from two images: about an unbiased method it comes out on either side of zero.
        sizes.append([" + ".join(method), *(("0" if sum(bias) <= 0 else mean_text(bias)) if bias else "–" for bias, _ in found)])
        totals = [(max(0.0, sum(bias)), sum(bias) + sum(variance)) for bias, variance in found]
        shares.append([" + ".join(method), *(f"{100 * b / total:.0f} %" if total > 0 else "–" for b, total in totals)])
    header = ["method", *map(pool_title, pools)]
    return [f"Bias squared at {budget} samples per pixel, in the unit of the MSE: what an average of many runs would keep (uncertain where few pixels bear the error; "
            "0 stands for an estimate that came out below):\n\n" + table(header, sizes),
            "Its share of the MSE:\n\n" + table(header, shares)]

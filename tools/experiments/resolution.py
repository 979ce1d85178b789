"""The same scenes at 256 and 512 pixels a side: a block of docs/experiments_full.md."""
import measured
from paper_chapters import EPOCHS, PRINTED
from results import Results
from tables import pool_title, table, with_interval

PLANS, SPP = ("e9_chess", "e10_balls"), 8
PAIRS = (("multiscale + directional", EPOCHS, "uniform + box", ("uniform", "box")),
         ("multiscale + directional", EPOCHS, "greedy_error + greedy_selection", ("greedy_error", "greedy_selection")),
         ("multiscale + directional", EPOCHS, "nl_means + nl_means", ("nl_means", "nl_means")),
         ("preset paper", PRINTED, "uniform + box", ("uniform", "box")))


def twins(sources):
    """[(file of 256 pixels, file of 512 pixels)] of one plan."""
    found = {measured.read_head(s)["recording"]: s for s in sources}
    pairs = [(found.get(name.removesuffix("_512"), found.get(name.removesuffix("512") + "256")), file) for name, file in found.items() if name.endswith("_512")]
    return [(small, large) for small, large in pairs if small]


def sizes(files):
    """Blocks, from all files of measured.py; none where no scene was measured at both sizes."""
    files = [file for plan in PLANS for pair in twins([f for f in files if f.parent.name == plan]) for file in pair]
    if not files:
        return []
    results = [Results([file]) for file in files]
    rows = [[f"{who} over {name}, {metric}", *(with_interval(r.ratio_or_made(metric.lower(), r.pools[0], SPP, ours, rival)) for r in results)]
            for who, ours, name, rival in PAIRS for metric in ("MSE", "relMSE")]
    titles = [f"{pool_title(r.pools[0]).removesuffix('_512')}, {'512' if r.pools[0].endswith('_512') else '256'}" for r in results]
    return ["## The same scenes at 256 and 512 pixels",
            f"Errors at {SPP} samples per pixel, each method with its filter, relative to another's; below 1 the first has the lower error. The intervals are of single ratios; E9 and E10 judge them together:\n\n"
            + table(["errors", *titles], rows)]

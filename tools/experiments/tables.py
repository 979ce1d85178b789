"""Markdown tables and sentences from results."""
import math

from inference import mean_of

POOL_TITLES = {
    "scene_s": "scene S", "scene_s_fireflies": "scene S with fireflies", "scene_s_128": "scene S, 128 x 128",
    "scene_s_fireflies_128": "scene S with fireflies, 128 x 128", "scene_s_512": "scene S, 512 x 512",
    "scene_s_fireflies_512": "scene S with fireflies, 512 x 512",
    **{f"scene_s_n{samples}": f"scene S, {samples} samples" for samples in (32, 64, 128, 256)},
}


def pool_title(pool):
    return POOL_TITLES.get(pool, pool.removesuffix("_256"))


def number(value, digits=3):
    """Three significant digits, no exponent between 0.001 and 10000."""
    if value is None or math.isnan(value):
        return "?"
    if value == 0:
        return "0"
    if not 1e-3 <= abs(value) < 1e4:
        return f"{value:.{digits - 1}e}"
    places = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:.{places}f}"


def with_interval(found):
    """0.123 [0.110, 0.138]"""
    if math.isnan(found.mean):
        return "–"
    if math.isnan(found.low) or found.low == found.high:
        return number(found.mean)
    return f"{number(found.mean)} [{number(found.low)}, {number(found.high)}]"


def mean_text(values):
    """Of a series that statistics.json does not hold."""
    return with_interval(mean_of(values))


def table(header, rows):
    return "\n".join(["| " + " | ".join(header) + " |", "|" + "---|" * len(header),
                      *("| " + " | ".join(row) + " |" for row in rows)])


def escaped(text):
    """As a cell of a table."""
    return text.replace("|", "\\|")


def method(results, sampler, filter_name):
    return sampler if len(results.filters) == 1 else f"{sampler} + {filter_name}"


def curves(results, pool, column="mse", base=("uniform", "box"), methods=None):
    """Rows: methods; columns: budgets. Ratios to `base`, which is given as it is."""
    budgets = results.budgets
    methods = methods or [(s, f) for s in results.samplers for f in results.filters]
    rows = [[f"*{' + '.join(base)}, {column.upper()}*",
             *(with_interval(results.figure(column, pool, *base, spp)) for spp in budgets)]] if base else []
    for sampler, filter_name in methods:
        if (sampler, filter_name) == base:
            continue
        row = [method(results, sampler, filter_name)]
        for spp in budgets:
            row.append(with_interval(results.ratio(column, pool, spp, (sampler, filter_name), base) if base
                                     else results.figure(column, pool, sampler, filter_name, spp)))
        if any(cell != "–" for cell in row[1:]):
            rows.append(row)
    return f"{pool_title(pool)}, {column}:\n\n" + table(
        ["at samples per pixel", *(f"{spp:g}" for spp in budgets)], rows)


LOST = 0.02  # share of the light; a method that loses more is not an estimate of the same picture


def cut(energy):
    """Three decimals, not rounded up: what loses more than LOST shows it."""
    return f"{math.floor(1000 * energy) / 1000:.3f}"


def energies(results, pool, a, b, budgets):
    """' (energy 0.879 / 0.952)', of a and of b at the budget where a gives least, if one of them loses light there; else ''."""
    found = [tuple(results.figure("energy_ratio", pool, *method, spp).mean for method in (a, b)) for spp in budgets]
    known = [pair for pair in found if pair[0] == pair[0] and pair[1] == pair[1]]
    lowest = min(known, default=(1.0, 1.0))
    return f" (energy {cut(lowest[0])} / {cut(lowest[1])})" if min(lowest) < 1.0 - LOST else ""


def compared(results, a, b, column="mse", pools=None, budgets=None):
    """'Table: below at 4, 8; above at 16 spp (energy 0.91 / 0.99). mist: ...': a against b, and the light of both where one loses some."""
    parts = []
    for pool in pools or results.pools:
        words = {-1: [], 0: [], 1: []}
        for spp in budgets or results.budgets:
            found = results.order(column, pool, spp, a, b)
            if found is not None:
                words[found].append(f"{spp:g}")
        said = [f"{name} at {', '.join(words[key])}" for key, name in
                ((-1, "below"), (0, "not told apart"), (1, "above")) if words[key]]
        if said:
            lost = "" if column.endswith("_fresh") else energies(results, pool, a, b, budgets or results.budgets)
            parts.append(f"{pool_title(pool)}: {'; '.join(said)} spp{lost}")
    return ". ".join(parts) + "." if parts else "not measured."


def tally(results, a, b, column="mse", pools=None, budgets=None):
    """How often a is below, not told apart from and above b."""
    found = [results.order(column, pool, spp, a, b)
             for pool in pools or results.pools for spp in budgets or results.budgets]
    return found.count(-1), found.count(0), found.count(1)


def finding(statement, results, a, b, column="mse", pools=None, budgets=None):
    """A statement 'a is below b', whether it came out, and where not."""
    below, level, above = tally(results, a, b, column, pools, budgets)
    total = below + level + above
    if total == 0:
        verdict = "not measured"
    elif below == total:
        verdict = "agrees"
    elif above == total:
        verdict = "**disagrees**"
    elif above == 0 and below > 0:
        verdict = "agrees, in part not told apart"
    elif below == 0 and above == 0:
        verdict = "undecided: not told apart"
    elif below == 0:
        verdict = "**disagrees**, in part not told apart"
    else:
        verdict = "**mixed**"
    said = compared(results, a, b, column, pools, budgets)
    return f"- {statement}: {verdict}. {said[0].upper()}{said[1:]}"

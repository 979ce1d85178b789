"""Markdown tables and sentences from results."""
import math

from results import mean, order, ratio, standard_error

POOL_TITLES = {
    "scene_s": "scene S", "scene_s_fireflies": "scene S with fireflies", "scene_s_128": "scene S, 128 x 128",
    "scene_s_fireflies_128": "scene S with fireflies, 128 x 128",
}


def pool_title(pool):
    return POOL_TITLES.get(pool, pool)


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


def with_error(value, error):
    """The value with as many places as its error needs: 0.1234 +- 0.0021."""
    if math.isnan(error):
        return number(value)
    if error <= 0 or not math.isfinite(error):
        return number(value, 4)
    if abs(value) < 1e-3 or abs(value) >= 1e4:
        return f"{value:.3g} ± {error:.1g}"
    places = min(6, max(0, 1 - math.floor(math.log10(error))))
    return f"{value:.{places}f} ± {error:.{places}f}"


def mean_text(values):
    return with_error(mean(values), standard_error(values)) if values else "–"


def ratio_text(a, b):
    found = ratio(a, b)
    return with_error(*found) if found else "–"


def table(header, rows):
    return "\n".join(["| " + " | ".join(header) + " |", "|" + "---|" * len(header),
                      *("| " + " | ".join(row) + " |" for row in rows)])


def method(results, sampler, filter_name):
    return sampler if len(results.filters) == 1 else f"{sampler} + {filter_name}"


def curves(results, pool, column="mse", base=("uniform", "box"), methods=None):
    """Rows: methods; columns: budgets. Ratios to `base`, which is given as it is."""
    budgets = results.budgets
    methods = methods or [(s, f) for s in results.samplers for f in results.filters]
    rows = [[f"*{' + '.join(base)}, {column.upper()}*",
             *(mean_text(results.values(column, pool, *base, spp)) for spp in budgets)]] if base else []
    for sampler, filter_name in methods:
        if (sampler, filter_name) == base:
            continue
        row = [method(results, sampler, filter_name)]
        for spp in budgets:
            values = results.values(column, pool, sampler, filter_name, spp)
            row.append(ratio_text(values, results.values(column, pool, *base, spp)) if base
                       else mean_text(values))
        if any(cell != "–" for cell in row[1:]):
            rows.append(row)
    return f"{pool_title(pool)}, {column}:\n\n" + table(
        ["at samples per pixel", *(f"{spp:g}" for spp in budgets)], rows)


def compared(results, a, b, column="mse", pools=None, budgets=None):
    """'on table below at 4, 8 and above at 16 spp, ...': a against b, beyond the noise."""
    parts = []
    for pool in pools or results.pools:
        words = {-1: [], 0: [], 1: []}
        for spp in budgets or results.budgets:
            found = order(results.values(column, pool, *a, spp), results.values(column, pool, *b, spp))
            if found is not None:
                words[found].append(f"{spp:g}")
        said = [f"{name} at {', '.join(words[key])}" for key, name in
                ((-1, "below"), (0, "level within the noise"), (1, "above")) if words[key]]
        if said:
            parts.append(f"{pool_title(pool)}: {'; '.join(said)} spp")
    return ". ".join(parts) + "." if parts else "not measured."


def tally(results, a, b, column="mse", pools=None, budgets=None):
    """How often a is below, level with and above b."""
    found = [order(results.values(column, pool, *a, spp), results.values(column, pool, *b, spp))
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
        verdict = "agrees, partly within the noise"
    elif below == 0 and above == 0:
        verdict = "undecided: within the noise"
    elif below == 0:
        verdict = "**disagrees**, partly within the noise"
    else:
        verdict = "**mixed**"
    return f"- {statement}: {verdict}. {compared(results, a, b, column, pools, budgets)[0].upper()}" \
           f"{compared(results, a, b, column, pools, budgets)[1:]}"

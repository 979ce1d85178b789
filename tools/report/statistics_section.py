"""Ranks, samples needed and slopes, as statistics.json of `spool evaluate` has them."""

import os
from html import escape

from failure import Failure
from number_text import number_text
from vocabulary import read_json

LONGEST_RANKING = 12


def read_statistics(folder):
    """Empty where the evaluation wrote none."""
    path = folder / "statistics.json"
    if not path.exists():
        return {}
    data = read_json(path)
    if not isinstance(data, dict):
        raise Failure(f"{path}: no statistics of spool evaluate: delete it or run spool evaluate again")
    return data


def statistics_html(statistics, labels, metric):
    """Empty where nothing was computed for this metric."""
    conditions = [c for c in statistics.get("conditions", []) if c.get("metric") == metric]
    curves = [c for c in statistics.get("curves", []) if c.get("metric") == metric]
    parts = [_rankings(conditions, labels, metric), _needed(curves, labels), _slopes(curves, labels)]
    if not any(parts):
        return ""
    about = ("<p>Pairs of methods are compared on the same replicates and pixel blocks; p-values are "
             "adjusted by Holm's rule for all pairs of a recording and budget. Methods share a rank "
             "where no difference is significant at 5 %.</p>")
    return about + "".join(parts)


def _label(entry, labels):
    stem = os.path.splitext(os.path.basename(entry.get("dump", "")))[0]
    name = labels.get(entry.get("dump"), stem)
    threads = entry.get("threads", 0)
    return name + (f", {number_text(threads)} threads" if threads else "")


def _method(entry):
    return f"{entry.get('sampler', '')} + {entry.get('filter', '')}"


def _range(entry, mean, low, high):
    def text(name):
        return "n/a" if entry.get(name) is None else number_text(entry[name], 3)
    bounds = entry.get(low) is not None and entry.get(high) is not None
    return text(mean) + (f" [{text(low)}, {text(high)}]" if bounds else "")


def _rankings(conditions, labels, metric):
    blocks = []
    for c in conditions:
        rows = []
        for entry in c["ranking"][:LONGEST_RANKING]:
            tie = " (tie)" if entry.get("tie") else ""
            rows.append(f'<tr><td class="number">{number_text(entry["rank"])}{tie}</td>'
                        f'<th scope="row">{escape(_method(entry))}</th>'
                        f'<td class="number">{_range(entry, "mean", "low", "high")}</td>'
                        f'<td class="number">{number_text(entry["p_against_best"], 2)}</td></tr>')
        rest = len(c["ranking"]) - LONGEST_RANKING
        more = f"<p>{rest} further methods: statistics.json has them.</p>" if rest > 0 else ""
        biased = " (biased)" if c.get("biased") else ""
        blocks.append(
            f'<details{" open" if not blocks else ""}><summary>{escape(_label(c, labels))} at '
            f'{number_text(c["spp"])} spp{biased}</summary><div class="scroll" tabindex="0"><table class="ranks">'
            f'<thead><tr><th scope="col">rank</th><th scope="col">method</th><th scope="col">'
            f'{escape(metric)}{biased}</th><th scope="col">p against the best</th></tr></thead><tbody>'
            f'{"".join(rows)}</tbody></table></div>{more}</details>')
    return f"<h3>Ranks</h3>{''.join(blocks)}" if blocks else ""


def _needed(curves, labels):
    rows = []
    for curve in curves:
        needed = curve.get("samples_for_the_error_of_uniform_box") or []
        if not needed:
            continue
        cells = ", ".join(
            f'{number_text(n["at"])} spp: {n["bound"] + " " if n["bound"] else ""}{_range(n, "spp", "low", "high")}'
            for n in needed)
        rows.append(f'<tr><th scope="row">{escape(_label(curve, labels))}</th>'
                    f"<td>{escape(_method(curve))}</td><td>{escape(cells)}</td></tr>")
    if not rows:
        return ""
    return ("<details><summary>Samples per pixel needed for the error of uniform + box</summary>"
            '<div class="scroll" tabindex="0"><table class="needed"><thead><tr><th scope="col">recording'
            '</th><th scope="col">method</th><th scope="col">for the error at, it takes</th></tr>'
            f'</thead><tbody>{"".join(rows)}</tbody></table></div></details>')


def _slopes(curves, labels):
    rows = "".join(f'<tr><th scope="row">{escape(_label(c, labels))}</th><td>{escape(_method(c))}</td>'
                   f'<td class="number">{_range(c, "slope", "slope_low", "slope_high")}</td></tr>'
                   for c in curves)
    if not rows:
        return ""
    return ("<details><summary>Slope of the error over the budget</summary><p>Logarithm of the error "
            "against logarithm of the samples; without a filter it is -1 where samples are "
            'independent.</p><div class="scroll" tabindex="0"><table class="slopes"><thead><tr>'
            '<th scope="col">recording</th><th scope="col">method</th><th scope="col">slope</th></tr>'
            f"</thead><tbody>{rows}</tbody></table></div></details>")

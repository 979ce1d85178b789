"""Ranks, samples needed and slopes, as statistics.json of `spool evaluate` has them."""

import os
from html import escape

from failure import Failure
from number_text import number_text
from statistics_file import interval_of

LONGEST_RANKING = 24


def statistics_html(statistics, labels, metric):
    """Empty where nothing was computed for this metric."""
    conditions = statistics.of_metric(metric)
    curves = [c for c in statistics.curves if c["metric"] == metric]
    parts = [_rankings(conditions, labels, metric), _needed(curves, labels), _slopes(curves, labels)]
    if not any(parts):
        return ""
    about = f"<p>{escape(statistics.rules.get('verdict', ''))} {escape(statistics.rules.get('interval', ''))}</p>"
    return about + "".join(parts)


def _label(entry, labels):
    stem = os.path.splitext(os.path.basename(entry["dump"]))[0]
    return labels.get(entry["dump"], stem)


def _method(entry):
    return f"{entry['sampler']} + {entry['filter']}"


def _interval(numbers):
    found = interval_of(numbers)
    text = "" if found.mean != found.mean else number_text(found.mean, 3)
    return text + ("" if found.low != found.low else f" [{number_text(found.low, 3)}, {number_text(found.high, 3)}]")


def _rank_row(entry):
    lost = entry.get("loses_energy")
    note = f"<small>loses {100 * lost:.2g} % of the energy</small>" if lost is not None else ""
    letters = entry["letters"] or ("" if entry["compared"] else "not compared")
    return (f'<tr><td class="letters">{escape(letters)}</td>'
            f'<th scope="row">{escape(_method(entry))}{note}</th>'
            f'<td class="number">{_interval(entry["value"])}</td>'
            f'<td class="number">{_interval(entry.get("ratio"))}</td>'
            f'<td>{escape(entry.get("against_baseline", ""))}</td>'
            f'<td class="number">{_interval(entry["energy"])}</td></tr>')


def _rankings(conditions, labels, metric):
    blocks = []
    for c in conditions:
        rows = [_rank_row(entry) for entry in c["ranking"][:LONGEST_RANKING]]
        rest = len(c["ranking"]) - LONGEST_RANKING
        more = f"<p>{rest} further methods: statistics.json has them.</p>" if rest > 0 else ""
        biased = " (biased)" if c.get("biased") else ""
        blocks.append(
            f'<details{" open" if not blocks else ""}><summary>{escape(_label(c, labels))} at '
            f'{number_text(c["spp"])} spp{biased}</summary><p>About {escape(c["about"]["text"])}.</p>'
            '<div class="scroll" tabindex="0"><table class="ranks">'
            f'<thead><tr><th scope="col">group</th><th scope="col">method</th><th scope="col">'
            f'{escape(metric)}{biased}</th><th scope="col">relative to uniform + box</th>'
            '<th scope="col">than uniform + box</th><th scope="col">energy</th></tr></thead><tbody>'
            f'{"".join(rows)}</tbody></table></div>{more}</details>')
    return f"<h3>Ranks</h3>{''.join(blocks)}" if blocks else ""


def _needed(curves, labels):
    rows = []
    for curve in curves:
        needed = curve.get("needed") or []
        if not needed:
            continue
        cells = ", ".join(
            f'{number_text(n["at"])} spp: {n["bound"] + " " if n["bound"] else ""}'
            + _interval([n["spp"], n["low"], n["high"]] if n["low"] is not None else [n["spp"]]) for n in needed)
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
                   f'<td class="number">{_interval(c["slope"])}</td></tr>' for c in curves)
    if not rows:
        return ""
    return ("<details><summary>Slope of the error over the budget</summary><p>Logarithm of the error "
            "against logarithm of the samples; without a filter it is -1 where samples are "
            'independent.</p><div class="scroll" tabindex="0"><table class="slopes"><thead><tr>'
            '<th scope="col">recording</th><th scope="col">method</th><th scope="col">slope</th></tr>'
            f"</thead><tbody>{rows}</tbody></table></div></details>")

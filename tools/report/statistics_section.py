"""Ranks, samples needed and slopes, as statistics.json of `spool evaluate` has them."""

import os
from html import escape

from tools.report.metric_names import metric_name
from tools.report.number_text import number_text
from tools.report.statistics_file import interval_of

LONGEST_RANKING = 24


def statistics_html(statistics, labels, metric):
    """Empty where nothing was computed for this metric."""
    conditions = statistics.of_metric(metric)
    curves = [c for c in statistics.curves if c["metric"] == metric]
    parts = [_rankings(conditions, labels, metric, statistics.baseline),
             _equal_time(curves, labels, statistics.baseline), _needed(curves, labels, statistics.baseline), _slopes(curves, labels)]
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
    if "withheld" in entry:
        letters = f"no verdict: {entry['withheld']}"
    return (f'<tr><td class="letters">{escape(letters)}</td>'
            f'<th scope="row">{escape(_method(entry))}{note}</th>'
            f'<td class="number">{_interval(entry["value"])}</td>'
            f'<td class="number">{_interval(entry.get("ratio"))}</td>'
            f'<td>{escape(entry.get("against_baseline", ""))}{_would_decide(entry)}</td>'
            f'<td class="number">{_interval(entry["energy"])}</td></tr>')


def _would_decide(entry):
    more = [f"about {number_text(count, 2)} {unit} would decide" for unit, count in entry.get("would_decide", {}).items()]
    return f"<small>{escape(more[0])}</small>" if more else ""


def _rankings(conditions, labels, metric, baseline):
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
            f'{escape(metric_name(metric))}{biased}</th><th scope="col">relative to {escape(baseline)}</th>'
            f'<th scope="col">than {escape(baseline)}</th><th scope="col">energy</th></tr></thead><tbody>'
            f'{"".join(rows)}</tbody></table></div>{more}</details>')
    return f"<h3>Ranks</h3>{''.join(blocks)}" if blocks else ""


def _equal_time(curves, labels, baseline):
    rows = []
    for curve in curves:
        for at in curve.get("equal_time") or []:
            found = at.get("outside") or _interval(at.get("ratio"))
            rows.append(f'<tr><th scope="row">{escape(_label(curve, labels))}</th><td>{escape(_method(curve))}</td>'
                        f'<td class="number">{number_text(at["at"])}</td>'
                        f'<td class="number">{number_text(at["seconds"] or 0.0, 3)}</td><td class="number">{escape(found)}</td></tr>')
    if not rows:
        return ""
    return (f"<details><summary>Error in the processor time of {escape(baseline)}</summary><p>Sampling, filtering and, where "
            "recorded, rendering; read from the budgets measured and never beyond them: too slow or too fast there.</p>"
            '<div class="scroll" tabindex="0"><table class="equal-time"><thead><tr><th scope="col">recording</th>'
            '<th scope="col">method</th><th scope="col">its spp</th><th scope="col">CPU seconds</th>'
            f'<th scope="col">ratio of the error</th></tr></thead><tbody>{"".join(rows)}</tbody></table></div></details>')


def _needed(curves, labels, baseline):
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
    return (f"<details><summary>Samples per pixel needed for the error of {escape(baseline)}</summary>"
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

"""Ranks, samples needed and slopes, as statistics.json of `spool evaluate` has them."""

from html import escape

from tools.report.number_text import known_text, number_text, percent_text, ratio_text, rounded_count
from tools.report.page import scrolled_table
from tools.report.statistics_file import interval_of
from tools.report.summary import name_of, unjudged

LONGEST_RANKING = 24


def statistics_html(statistics, labels, metric):
    """Empty where nothing was computed for this metric."""
    conditions = statistics.of_metric(metric)
    curves = [c for c in statistics.curves if c["metric"] == metric]
    parts = [_rankings(conditions, labels, statistics.metric_text(metric), statistics.baseline, statistics.letters_note(metric)),
             _equal_time(curves, labels, statistics.baseline), _needed(curves, labels, statistics.baseline), _slopes(curves, labels)]
    if not any(parts):
        return ""
    about = f"<p>{escape(statistics.rules.get('verdict', ''))} {escape(statistics.rules.get('interval', ''))}</p>"
    return about + "".join(parts)


def _interval(numbers):
    return known_text(interval_of(numbers))


def _rank_row(entry, baseline):
    lost = entry.get("loses_energy")
    note = f"<small>loses {percent_text(lost)} of the energy</small>" if lost is not None else ""
    letters = f"no verdict: {entry['withheld']}" if "withheld" in entry else entry["letters"] or unjudged(entry)
    return (f'<tr><td class="letters">{escape(letters)}</td>'
            f'<th scope="row">{escape(name_of(entry))}{note}</th>'
            f'<td class="number">{_interval(entry["value"])}</td>'
            + (f'<td class="number">{ratio_text(interval_of(entry.get("ratio")))}</td>'
               f'<td>{escape(entry.get("against_baseline", ""))}{_why(entry)}</td>' if baseline else "")
            + f'<td class="number">{_interval(entry["energy"])}</td></tr>')


def _why(entry):
    """Of what is not decided: what would, or why the baseline's own error does not."""
    why = [f"about {rounded_count(count)} {unit} would decide" for unit, count in entry.get("would_decide", {}).items()]
    why += [f"of the baseline: {entry['baseline_withheld']}"] if "baseline_withheld" in entry else []
    return f"<small>{escape(why[0])}</small>" if why else ""


def _rankings(conditions, labels, metric_text, baseline, note):
    blocks, heads = [], (f"relative to {escape(baseline)}", f"than {escape(baseline)}") if baseline else ()
    for c in conditions:
        rows = [_rank_row(entry, baseline) for entry in c["ranking"][:LONGEST_RANKING]]
        rest = len(c["ranking"]) - LONGEST_RANKING
        more = f"<p>{rest} further methods: statistics.json has them.</p>" if rest > 0 else ""
        blocks.append(
            f'<details{" open" if not blocks else ""}><summary>{escape(labels[c["dump"]])} at '
            f'{number_text(c["spp"])} spp</summary><p>About {escape(c["about"]["text"])}.</p>'
            + scrolled_table("ranks", ("group", "method", escape(metric_text), *heads, "energy"), rows) + f"{more}</details>")
    return f"<h3>Ranks</h3>{note and f'<p>{note}</p>'}{''.join(blocks)}" if blocks else ""


def _equal_time(curves, labels, baseline):
    rows = []
    for curve in curves:
        for at in curve.get("equal_time") or []:
            found = at.get("outside") or ratio_text(interval_of(at.get("ratio")))
            rows.append(f'<tr><th scope="row">{escape(labels[curve["dump"]])}</th><td class="name">{escape(name_of(curve))}</td>'
                        f'<td class="number">{number_text(at["at"])}</td>'
                        f'<td class="number">{number_text(at["seconds"] or 0.0, 3)}</td><td class="number">{escape(found)}</td></tr>')
    return _folded(f"Error in the processor time of {escape(baseline)}", "<p>Sampling, filtering and, where "
                   "recorded, rendering; read from the budgets measured and never beyond them: too slow or too fast there.</p>",
                   "equal-time", ("recording", "method", "its spp", "CPU seconds", "ratio of the error"), rows)


def _needed(curves, labels, baseline):
    rows = []
    for curve in curves:
        cells = ", ".join(
            f'{number_text(n["at"])} spp: {n["bound"] + " " if n["bound"] else ""}'
            + _interval([n["spp"], n["low"], n["high"]] if n["low"] is not None else [n["spp"]]) for n in curve.get("needed") or [])
        if cells:
            rows.append(f'<tr><th scope="row">{escape(labels[curve["dump"]])}</th><td class="name">{escape(name_of(curve))}</td><td>{escape(cells)}</td></tr>')
    return _folded(f"Samples per pixel needed for the error of {escape(baseline)}", "", "needed", ("recording", "method", "for the error at, it takes"), rows)


def _slopes(curves, labels):
    rows = [f'<tr><th scope="row">{escape(labels[c["dump"]])}</th><td class="name">{escape(name_of(c))}</td>'
            f'<td class="number">{_interval(c["slope"])}</td></tr>' for c in curves]
    return _folded("Slope of the error over the budget", "<p>Logarithm of the error "
                   "against logarithm of the samples; without a filter it is -1 where samples are independent.</p>",
                   "slopes", ("recording", "method", "slope"), rows)


def _folded(title, about, kind, heads, rows):
    """A table that can be opened; empty without rows."""
    return f"<details><summary>{title}</summary>{about}{scrolled_table(kind, heads, rows)}</details>" if rows else ""

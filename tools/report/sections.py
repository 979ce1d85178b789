"""The parts of a report that are words and small tables, as HTML."""

import math
from collections import Counter, defaultdict
from html import escape

from tools.report.metric_names import metric_name
from tools.report.number_text import count_text, number_text, ratio_text
from tools.report.page import licences_html, scrolled_table
from tools.report.statistics_file import interval_of
from tools.report.summary import late_text, leading, said_text, threads_text, verdict_text, verdicts

LONGEST_VERDICTS = 60


def summary_html(sentences, statistics, metric, budget):
    """Claims, then table, chart and crops drawn by headline.js, then at most five sentences; the rest can be opened."""
    first = leading(sentences, statistics, metric, budget)
    scopes = "".join(f'<p class="note">{escape(s.text)}</p>' for s in sentences if s.kind == "scope")
    unranked = ("" if metric in statistics.metrics() or not statistics.metrics() else
                f"<p>Methods are not ranked by {escape(metric_name(metric))}, but by {escape(', '.join(map(metric_name, statistics.metrics())))}.</p>")
    shown = "".join(f'<li class="{s.kind}">{escape(s.text)}</li>' for s in first)
    rest = [s for s in sentences if s.kind != "scope" and s not in first]
    more = "".join(f'<li class="{s.kind}">{escape(s.text)}</li>' for s in rest)
    table = _verdict_table(statistics, metric)
    return (f'{"".join(_claim(claim, statistics.labels()) for claim in statistics.claims)}{unranked}<div id="headline-area"></div><ul class="leading">{shown}</ul>{scopes}'
            f"<details><summary>Every verdict in words, and {escape(metric_name(metric))} at every budget</summary>"
            f"<ul>{more}</ul>{table}</details>{HOW_TO_READ}")


def _claim(claim, labels):
    """A question of the plan with the verdict that statistics.json has; opens on the places it was asked at."""
    limit = "" if claim["below"] == 1 else f" {number_text(claim['below'])} times"
    asked = (f"{claim['metric']} of {claim['better']} below{limit} that of {claim['than']}, {claim['samples']} samples"
             + (f"; {count_text(claim['threads'][0], 'thread')} against {claim['threads'][1]}" if "threads" in claim else "") + (f"; {claim['source']}" if claim.get("source") else ""))
    counts = ", ".join(f"{count} {verdict}" for verdict, count in claim["counts"].items())
    rows = (f'<tr><th scope="row">{escape(labels.get(place["dump"], place["dump"]) + threads_text(claim, place))}</th>'
            f'<td class="number">{place["spp"]:g}</td><td class="number">{ratio_text(interval_of(place.get("ratio")))}</td>'
            f'<td>{escape(verdict_text(place))}</td></tr>'
            for place in claim["places"])
    return (f'<details class="claim {escape(claim["verdict"].replace(" ", "-"))}"><summary><b>{escape(claim["verdict"])}</b> '
            f"{escape(claim['text'])}{late_text(claim)} <small>{escape(counts)}</small></summary><p>{escape(asked)}</p>"
            f'{scrolled_table("", ("recording", "spp", "ratio", "verdict"), rows)}</details>')


HOW_TO_READ = (
    "<details><summary>How to read this</summary><p>Values are means over replicates with their 95 % "
    "interval in brackets; each interval is computed for itself. Where all values are positive the mean is geometric, so that a "
    "ratio is the quotient of two means. An interval says where the mean of another recording of the scene "
    "would lie; it does not say how another scene would come out. With one replicate it is a bootstrap over "
    "blocks of pixels. Whether two methods differ is decided for all pairs of a scene and budget together at "
    "5 %; words and letters are these verdicts, so an interval that excludes 1 may stand beside "
    "\"undecided\". Errors are debiased by the variance of the reference, so a very good image may come out "
    "at or below zero: such an error is not resolved.</p></details>")


def _verdict_table(statistics, metric):
    table, dumps = verdicts(statistics, metric), len(statistics.scenes)
    if not table:
        return ""
    methods = list(dict.fromkeys(method for method, _ in table))
    budgets = sorted({spp for _, spp in table})
    rows = []
    for method in methods[:LONGEST_VERDICTS]:
        cells = "".join(_verdict_cell(table.get((method, spp))) for spp in budgets)
        rows.append(f'<tr><th scope="row">{escape(method)}</th>{cells}</tr>')
    rest = len(methods) - LONGEST_VERDICTS
    more = f"<p>{rest} further methods: see the table.</p>" if rest > 0 else ""
    over = ("with its 95 % interval, and the verdict" if dumps == 1 else
            f"geometric mean over {dumps} scenes with its interval; below it, on how many scenes which verdict")
    return (f"<p>{escape(statistics.metric_text(metric))} relative to {escape(statistics.baseline)} at the same budget: {over}.</p>"
            f'{scrolled_table("verdicts", ("method", *(f"{spp:g} spp" for spp in budgets)), rows)}{more}')


def _verdict_cell(verdict):
    if verdict is None:
        return "<td></td>"
    note = said_text(verdict.said)
    word = next((word for word in ("better", "worse") if [*verdict.said] == [word]), "undecided")  # of all scenes
    ratio = "not resolved" if math.isnan(verdict.ratio.mean) else ratio_text(verdict.ratio)
    return f'<td class="{word}">{ratio}<small>{escape(note)}</small></td>'


def guards_html(combinations, labels, vocabulary):
    """What was clamped, rejected, replaced or ran out, per guard, with where it was most."""
    totals, caught, worst = Counter(), defaultdict(set), {}
    for c in combinations:
        for name, count in c.guards.items():
            totals[name] += count
            caught[name].add(id(c))
            if name not in worst or count > worst[name][0]:
                worst[name] = (count, c)
    excluded = sum(row.get("excluded_image", 0) or 0 for c in combinations for row in c.rows)
    warning = ("" if excluded <= 0 else f'<p class="warning">Pixels of images that are not finite and were left out of every error: {excluded:,.0f}. '
               "Those results count as failed.</p>")
    rows = []
    for name, total in totals.most_common():
        count, c = worst[name]
        meaning = vocabulary.guard_meaning(name)
        rows.append(
            f'<tr><th scope="row">{escape(name)}<small>{escape(meaning)}</small></th>'
            f"<td>{total:,.0f}</td><td>{len(caught[name])} of {len(combinations)}</td>"
            f"<td class=\"name\">{escape(c.method)}, {escape(labels[c.dump])}, {c.spp:g} spp: {count:,.0f}</td></tr>")
    return warning + ("" if not rows else "<details><summary>Samples and pixels that were clamped, rejected or replaced</summary>"
                      "<p>Every clamp, floor and early-out that caught something, counted over all replicates.</p>"
                      f'{scrolled_table("guards", ("guard", "count", "in combinations", "most in"), rows)}</details>')


def run_html(manifest, combinations, labels, vocabulary):
    """Command, program, machine, recordings; what was not recorded is said to be so."""
    rows = [("command", _text(manifest.get("command"))),
            ("program", _text(manifest.get("version"))),
            ("machine", _text(manifest.get("machine"))),
            ("started", _text(manifest.get("started"))),
            ("report by", f"spool {vocabulary.version}" if vocabulary.version else "")]
    first = next((row for c in combinations for row in c.rows), {})
    rows.append(("judged by", ", ".join(sorted({
        row.get("reference", "") for c in combinations for row in c.rows} - {""}))))
    threads = first.get("threads_used", math.nan)
    rows.append(("threads", "" if math.isnan(threads) else f"{threads:g}"))
    if any(row.get("timing") == "shared" for c in combinations for row in c.rows):
        rows.append(("times", "of a machine that other results shared (column timing)"))
    html = "".join(f"<dt>{escape(name)}</dt><dd>{_value_html(name, value)}</dd>"
                   for name, value in rows)
    hashes = {str(d.get("path", "")): d for d in manifest.get("dumps", []) if isinstance(d, dict)}
    body = []
    for dump, label in labels.items():
        row = next((r for c in combinations if c.dump == dump for r in c.rows), {})
        size = (f"{row['width']:g} x {row['height']:g}"
                if math.isfinite(row.get("width", math.nan)) else "")
        known = hashes.get(dump, {})
        digest = _text(known.get("index_sha256") or known.get("sha256")) or "not recorded"  # the second of an older program
        body.append(f'<tr><th scope="row">{escape(label)}</th><td class="name">{escape(dump)}</td><td>{size}</td>'
                    f"<td>{_known(row.get('holdout'))}</td><td><code>{escape(digest)}</code></td></tr>")
    table = scrolled_table("", ("name", "file", "pixels", "held out", "hash of its index"), body, "<caption>Recordings</caption>")
    return f'<dl class="run">{html}</dl>{table}{guards_html(combinations, labels, vocabulary)}{licences_html()}'


def _known(value):
    return "" if value is None or math.isnan(value) else f"{value:g} spp"


def _text(value):
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item)}" for key, item in value.items() if _text(item))
    if isinstance(value, list):
        return " ".join(_text(item) for item in value)
    return "" if value is None else str(value)


def _value_html(name, value):
    if not value:
        return '<span class="unknown">not recorded</span>'
    return f"<code>{escape(value)}</code>" if name == "command" else escape(value)


def quantities_html(names, vocabulary, own):
    items = "".join(f"<dt>{escape(name)}</dt><dd>{escape(own.get(name) or vocabulary.meaning(name))}"
                    "</dd>" for name in names if own.get(name) or vocabulary.meaning(name))
    return f"<details><summary>What the columns mean</summary><dl>{items}</dl></details>" if items else ""

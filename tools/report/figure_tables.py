"""Tables for a paper, LaTeX and Markdown, and the CSV of curves. Every number is one of statistics.json; the best is bold
only where its verdicts separate it from every other method."""

import csv
import io
from typing import NamedTuple

from tools.report.figure_text import breakable, latex, printable, significant
from tools.report.metric_names import BIASED
from tools.report.number_text import digits_of_ratio, samples_text
from tools.report.statistics_file import Interval, best_is_alone, interval_of
from tools.report.summary import late_text, name_of, threads_text, unjudged, verdict_text

MOST_LINES = 34  # of a table that fits into a column
BOLD = "the best, separated from every other method that is compared"
NO_VERDICT = "no verdict, and no interval of a ratio to it"
LATEX_MARKS = {"†": r"$\dagger$", "‡": r"$\ddagger$"}
LINE_LETTERS = 24  # of a name


class Row(NamedTuple):
    method: str
    value: Interval
    ratio: Interval
    letters: str
    bold: bool
    loses: bool
    unjudged: str  # why there is no verdict; "" where there is

    def marks(self):
        return ("†" if self.loses else "") + ("‡" if self.unjudged else "")


def rows_of(condition):
    alone = best_is_alone(condition)
    return [Row(name_of(entry), interval_of(entry["value"]), interval_of(entry.get("ratio")), entry["letters"],
                alone and place == 0, "loses_energy" in entry, unjudged(entry)) for place, entry in enumerate(condition["ranking"])]


def by_scene(statistics, metric):
    """{scene: [condition]}, budgets in order"""
    scenes = {}
    for condition in statistics.of_metric(metric):
        scenes.setdefault(condition["dump"], []).append(condition)
    return {dump: sorted(conditions, key=lambda c: c["spp"]) for dump, conditions in scenes.items()}


def ratio_number(value):
    return significant(value, digits_of_ratio(value, 3, significant))


def latex_interval(interval, bold=False, number=significant):
    """`number`: how one is written."""
    if interval.mean != interval.mean:
        return ""
    mean = latex_number(number(interval.mean))
    text = rf"\mathbf{{{mean}}}" if bold else f"{{{mean}}}" if "^" in mean else mean
    if interval.low == interval.low and interval.high == interval.high:
        text += rf"_{{\,{latex_number(number(interval.low))}}}^{{\,{latex_number(number(interval.high))}}}"
    return f"${text}$"


def latex_number(text):
    mantissa, _, exponent = text.partition("e")
    return mantissa + (rf"{{\cdot}}10^{{{exponent}}}" if exponent else "")


def parts_of(rows, name):
    """Lists of rows, each of which fits into a column; `name`: what is broken into lines there."""
    parts, lines = [[]], 0
    for row in rows:
        lines += 1 + len(name(row)) // LINE_LETTERS
        if lines > MOST_LINES and parts[-1]:
            parts.append([])
            lines = 1 + len(name(row)) // LINE_LETTERS
        parts[-1].append(row)
    return [part for part in parts if part]


def framed(caption, columns, lines):
    """A table of these columns, as lines of LaTeX."""
    return [r"\begin{table}", rf"\caption{{{caption}}}", r"\smallskip\footnotesize", r"\setlength{\tabcolsep}{3pt}",
            r"\begin{tabularx}{\linewidth}{@{}>{\raggedright\arraybackslash}" + columns + "@{}}", r"\toprule", *lines,
            r"\bottomrule", r"\end{tabularx}", r"\end{table}", ""]


def latex_tables(statistics, metric, labels, baseline, captions):
    """One table for each recording, of several parts where it has many rows. `captions`: of a scene and its part."""
    text = [r"% needs \usepackage{booktabs,tabularx}", ""]
    for dump, conditions in by_scene(statistics, metric).items():
        lines = [(rf"\multicolumn{{4}}{{@{{}}l}}{{\emph{{{samples_text(c['spp'])}}}}} \\", row)
                 for c in conditions for row in rows_of(c)]
        parts = parts_of(lines, lambda line: line[1].method)
        for i, part in enumerate(parts):
            inside, shown = [rf"& {latex(statistics.metric_text(metric))} & {'ratio' if baseline else ''} & \\"], None
            for budget, row in part:
                inside += [r"\midrule", budget] if budget != shown else []
                shown = budget
                inside.append(" & ".join([breakable(row.method), latex_interval(row.value, row.bold), latex_interval(row.ratio, number=ratio_number),
                                        latex(row.letters) + "".join(LATEX_MARKS[m] for m in row.marks())])
                              + r" \\[2pt]")
            text += framed(captions(dump, i, len(parts)), "Xrrl", inside)
    return "\n".join([*text, *claims_table(statistics, labels)])


def claim_rows(claims, labels):
    """[(text or "", where, verdict, ratio)], as the program gives them."""
    rows = []
    for claim in claims:
        rows.append((claim["text"] + late_text(claim), "", claim["verdict"], Interval()))
        rows += [("", f"{labels.get(place['dump'], place['dump'])}, {place['spp']:g} spp{threads_text(claim, place)}",
                  verdict_text(place), interval_of(place.get("ratio"))) for place in claim["places"]]
    return rows


def claims_table(statistics, labels):
    text = []
    for part in parts_of(claim_rows(statistics.claims, labels), lambda row: row[0] or row[1]):
        lines = [rf"{breakable(claim) if claim else chr(92) + 'quad ' + breakable(where)} & {latex(verdict)} & "
                 rf"{latex_interval(ratio, number=ratio_number)} \\[2pt]" for claim, where, verdict, ratio in part]
        text += framed(r"Claims of the plan and what the results say of them. Ratio: error of the method that is claimed to be better over "
                       r"that of the other; sub- and superscript: ends of its 95\,\% interval. " + latex(statistics.judged_text()), "Xlr",
                       [r"claim & verdict & ratio \\", r"\midrule", *lines])
    return text


def markdown(text):
    for c in "\\|*_`<>[]&~$":
        text = text.replace(c, "\\" + c)
    return printable(text)


def plain_interval(interval, number=significant):
    if interval.mean != interval.mean:
        return ""
    text = number(interval.mean)
    known = interval.low == interval.low and interval.high == interval.high
    return text + (f" [{number(interval.low)}, {number(interval.high)}]" if known else "")


def markdown_table(statistics, metric, labels, baseline):
    lines = []
    for dump, conditions in by_scene(statistics, metric).items():
        for condition in conditions:
            lines += [f"**{markdown(labels[dump])}, {samples_text(condition['spp'])}**", "",
                      f"| method | {markdown(statistics.metric_text(metric))} | ratio | |", "|---|---:|---:|---|"]
            for row in rows_of(condition):
                value = markdown(plain_interval(row.value))
                lines.append("| " + " | ".join([markdown(row.method), f"**{value}**" if row.bold else value,
                                                markdown(plain_interval(row.ratio, ratio_number)),
                                                f"{row.letters} {row.marks()}".strip()]) + " |")
            lines.append("")
    lines += ["Means with 95 % intervals" + (f"; ratio: to {markdown(baseline)}" if baseline else "") + ". Methods that share "
              "a letter are not separated; bold: " + BOLD + "; †: loses light; ‡: " + NO_VERDICT + "." + statistics.failed_text() + " "
              + " ".join([statistics.judged_text(), statistics.letters_note(metric)]).rstrip(), ""]
    for claim, where, verdict, ratio in claim_rows(statistics.claims, labels):
        lines.append(markdown(f"{claim}: {verdict}") if claim else
                     "- " + markdown(f"{where}: {verdict} {plain_interval(ratio, ratio_number)}".rstrip()))
    return "\n".join([*lines, ""] if statistics.claims else lines)


def csv_text(text):
    """A spreadsheet computes a cell that begins like a formula, quoted or not: ' keeps it text. draw_curves.py
    takes the ' away again."""
    text = printable(text)
    return "'" + text if text[:1] in tuple("=+-@'") else text


def curves_csv(statistics, metric, labels, drawn):
    """Every method at every budget; `drawn`: those that the script draws, numbered from 1 in their order."""
    seconds = {(r["dump"], r["spp"], name_of(r)): interval_of(r.get("quantities", {}).get("seconds_total")).mean
               for r in statistics.results}
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["scene", "method", "spp", "metric", "mean", "low", "high", "seconds", "drawn"])
    for condition in statistics.of_metric(metric):
        for entry in condition["ranking"]:
            name = name_of(entry)
            numbers = [*interval_of(entry["value"]), seconds.get((condition["dump"], condition["spp"], name), float("nan"))]
            writer.writerow([csv_text(labels[condition["dump"]]), csv_text(name), f"{condition['spp']:g}", csv_text(metric + BIASED * statistics.biased),
                             *("" if n != n else repr(n) for n in numbers), drawn.index(name) + 1 if name in drawn else 0])
    return out.getvalue()

"""Tables for a paper, LaTeX and Markdown, and the CSV of curves. The best is bold only where the verdicts of
statistics.json tell it apart from every other method."""

import csv
import io

from headline_data import best_is_alone
from number_text import interval_text
from statistics_file import interval_of
from summary import name_of

LATEX = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}


def printable(text):
    """One line without control characters, which neither LaTeX nor XML can hold."""
    return "".join(c if c.isprintable() else " " for c in text)


def latex(text):
    return "".join(LATEX.get(c, "\\" + c if c in "{}$&#_%" else c) for c in printable(text))


def markdown(text):
    for c in "\\|*_`<>[]":
        text = text.replace(c, "\\" + c)
    return printable(text)


def csv_text(text):
    """A spreadsheet computes a cell that begins like a formula, quoted or not: ' keeps it text. draw_curves.py
    takes the ' away again."""
    text = printable(text)
    return "'" + text if text[:1] in tuple("=+-@'") else text


class Cell:
    def __init__(self, text, letters="", bold=False):
        self.text, self.letters, self.bold = text, letters, bold


def cells_of(statistics, metric):
    """{scene: {method: {spp: Cell}}}, and the budgets"""
    table, budgets = {}, []
    for condition in statistics.of_metric(metric):
        alone = best_is_alone(condition["ranking"])
        budgets.append(condition["spp"])
        for place, entry in enumerate(condition["ranking"]):
            lost = " (-)" if "loses_energy" in entry else ""
            cell = Cell(interval_text(interval_of(entry["value"]), 3) + lost, entry["letters"], alone and place == 0)
            table.setdefault(condition["dump"], {}).setdefault(name_of(entry), {})[condition["spp"]] = cell
    return table, sorted(set(budgets))


def latex_table(statistics, metric, labels):
    table, budgets = cells_of(statistics, metric)
    lines = [r"% needs \usepackage{booktabs}; superscripts: methods that share a letter are not told apart",
             r"\begin{tabular}{l" + "r" * len(budgets) + "}", r"\toprule",
             " & ".join([latex(metric), *(f"{b:g} spp" for b in budgets)]) + r" \\"]
    for dump, methods in table.items():
        lines += [r"\midrule", rf"\multicolumn{{{len(budgets) + 1}}}{{l}}{{\emph{{{latex(labels[dump])}}}}} \\"]
        for method, row in methods.items():
            lines.append(" & ".join([latex(method), *(_latex_cell(row.get(b)) for b in budgets)]) + r" \\")
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}",
                      "% (-): loses energy. Intervals: 95 %, each for itself.", ""])


def _latex_cell(cell):
    if cell is None:
        return ""
    text = latex(cell.text)
    text = rf"\textbf{{{text}}}" if cell.bold else text
    return text + (rf"\textsuperscript{{{latex(cell.letters)}}}" if cell.letters else "")


def markdown_table(statistics, metric, labels):
    table, budgets = cells_of(statistics, metric)
    lines = []
    for dump, methods in table.items():
        lines += [f"**{markdown(labels[dump])}**", "", "| " + " | ".join(
            [markdown(metric), *(f"{b:g} spp" for b in budgets)]) + " |", "|---" + "|---:" * len(budgets) + "|"]
        for method, row in methods.items():
            lines.append("| " + " | ".join([markdown(method), *(_markdown_cell(row.get(b)) for b in budgets)]) + " |")
        lines.append("")
    lines += ["Means with 95 % intervals. Methods that share a letter are not told apart; bold: told apart from every "
              "other method; (-): loses energy.", ""]
    return "\n".join(lines)


def _markdown_cell(cell):
    if cell is None:
        return ""
    text = markdown(cell.text)
    return (f"**{text}**" if cell.bold else text) + (f" {cell.letters}" if cell.letters else "")


def curves_csv(statistics, metric, labels, drawn):
    """Every method at every budget; `drawn`: those that the script draws."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["scene", "method", "spp", "metric", "mean", "low", "high", "drawn"])
    for condition in statistics.of_metric(metric):
        for entry in condition["ranking"]:
            numbers = ["" if n != n else repr(n) for n in interval_of(entry["value"])]
            writer.writerow([csv_text(labels[condition["dump"]]), csv_text(name_of(entry)), f"{condition['spp']:g}",
                             csv_text(metric), *numbers, int(name_of(entry) in drawn)])
    return out.getvalue()

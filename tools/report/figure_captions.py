"""captions.tex: every figure as an environment with the caption that its numbers need."""

from tools.report.aggregate import MARK
from tools.report.figure_tables import BOLD, NO_VERDICT
from tools.report.figure_text import breakable, latex
from tools.report.number_text import count_text, list_text, percent_text, samples_text
from tools.report.statistics_file import interval_of
from tools.report.summary import name_of, unjudged

LONGEST = 12  # of a list of names


def environment(files, caption, column):
    """`files`: names without ending."""
    kind, width = ("figure*", r"\textwidth") if column == 2 else ("figure", r"\columnwidth")
    lines = []
    for i, file in enumerate(files):
        note = r" \emph{(continued)}" if i else ""
        lines += [rf"\begin{{{kind}}}", r"\centering", rf"\includegraphics[width={width}]{{{file}.pdf}}",
                  rf"\caption{{{caption}{note}}}", rf"\label{{fig:{file}}}", rf"\end{{{kind}}}", ""]
    return lines


def replicates_text(statistics):
    counts = sorted({entry["replicates"] for entry in statistics.results if entry["replicates"]})
    several = f"{counts[0]:g}" if len(counts) == 1 else f"{counts[0]:g} to {counts[-1]:g}"
    return f"{several} replicate{'' if several == '1' else 's'}"


def numbers_text(statistics, metric, conditions):
    """What the numbers of figure and table are about."""
    better = "1 is best" if metric.startswith("energy") else "smaller is better"
    about = " or ".join(dict.fromkeys(c["about"]["text"].split(";")[0] for c in conditions))
    widened = "; they are wider where replicates share samples" if any(c["about"]["kind"] == "shared" for c in conditions) else ""
    return (rf"Numbers are means of {latex(statistics.metric_text(metric))} over {replicates_text(statistics)} with 95\,\% intervals "
            f"({better}).{statistics.failed_text()} {latex(statistics.judged_text())} Intervals and verdicts are about {latex(about)}{widened}.")


def notes(conditions, methods):
    """Of the methods that are shown: who loses light, and which are no originals."""
    lost = {}
    for entry in (e for c in conditions for e in c["ranking"] if name_of(e) in methods):
        lost.setdefault(name_of(entry), []).append(entry.get("loses_energy", 0.0))
    names = [f"{name} ({'up to ' if len(shares) > 1 else ''}{percent_text(max(shares))})" for name, shares in lost.items() if max(shares)]
    text = f" Light is lost by {breakable(list_text(names, LONGEST))}." if names else ""
    why = reasons(e.get("withheld") for c in conditions for e in c["ranking"] if name_of(e) in methods)
    text += f" Means without an interval: withheld ({why})." if why else ""
    if any(MARK in name for name in methods):
        text += " [R]: implemented again from a description."
    return text


def reasons(found):
    """Each once; empty where there is none."""
    return latex("; ".join(sorted(set(filter(None, found)))))


def comparison_caption(statistics, metric, conditions, shown, labels):
    """`shown`: the blocks of the figure."""
    names = list_text([breakable(label) for label in labels], LONGEST)
    methods = list(dict.fromkeys(s.method for block in shown for s in block.methods.values()))
    judged = all(block.judged for block in shown)
    seen = [*map(breakable, methods), *(["the reference"] if judged else [])]
    text = (f"{names} at {samples_text(conditions[0]['spp'])}. Left: {'the reference' if judged else 'a picture'} with "
            f"its windows; then these windows of {list_text(seen, LONGEST)}, at one exposure.")
    if len(shown) == 1:
        text += " Below them: squared error, on one scale."
    text += " " + numbers_text(statistics, metric, conditions)
    if any(s.bold for block in shown for s in block.methods.values()):
        text += f" Bold: {BOLD} of the evaluation."
    return text + notes(conditions, methods)


def curves_caption(statistics, metric, methods, over_time, shared, commands):
    conditions = statistics.of_metric(metric)
    text = latex(statistics.metric_text(metric)) + " over " + (
        "time: of sampling and filtering, and of rendering the samples where the recording says it" if over_time else
        "samples per pixel; points at one budget stand beside each other") + ", on logarithmic axes. "
    text += numbers_text(statistics, metric, conditions)
    if over_time and shared:
        text += " Results were made beside each other on one machine, so times are longer than alone."
    if over_time and commands:
        text += (" Times of " + list_text([breakable(name) for name in commands], LONGEST)
                 + " have the start of a command and its files in them.")
    left_out = sum(interval_of(e["value"]).mean <= 0 for c in conditions for e in c["ranking"] if name_of(e) in methods)
    text += f" Not drawn: {count_text(left_out, 'mean')} not above zero." if left_out else ""
    return text + notes(conditions, methods)


def table_caption(statistics, metric, labels, baseline):
    """A function of a scene and of the part of its table."""
    def caption(dump, part, parts):
        conditions = [c for c in statistics.of_metric(metric) if c["dump"] == dump]
        methods = [name_of(e) for c in conditions for e in c["ranking"]]
        text = latex(statistics.metric_text(metric)) + " on " + breakable(labels[dump])
        text += f" (part {part + 1} of {parts})" if parts > 1 else ""
        text += ". " + numbers_text(statistics, metric, conditions) + " Sub- and superscript: ends of the interval."
        if baseline:
            text += f" Ratio: error over that of {breakable(baseline)} on the same replicates."
        text += " Methods that share a letter are not separated; bold: " + BOLD + "."
        text += " ".join(["", latex(statistics.letters_note(metric))]).rstrip()
        if any("loses_energy" in e for c in conditions for e in c["ranking"]):
            text += r" $\dagger$: loses light."
        why = reasons(unjudged(e) for c in conditions for e in c["ranking"])
        text += rf" $\ddagger$: {NO_VERDICT} ({why})." if why else ""
        if any(MARK in name for name in methods):
            text += " [R]: implemented again from a description."
        return text
    return caption

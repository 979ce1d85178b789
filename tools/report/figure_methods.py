"""Which methods a figure shows: those of the user first, the baseline, then the first of the ranking."""

import re

from tools.report.aggregate import MARK
from tools.report.failure import USAGE, Failure
from tools.report.number_text import list_text
from tools.report.summary import name_of

MOST_METHODS = 8
MOST_OWN = 6
USUAL = 5
NAMED = 250  # letters of names in an error, which is cut at 400
ARGUMENTS = ("exec", "import", "image", "counts", "python")  # their names are followed by what the user wrote


def baseline_of(conditions):
    """The method that the others' ratios are to: the only one of a ranking that is not compared with it."""
    for condition in conditions:
        alone = [entry for entry in condition["ranking"] if "against_baseline" not in entry]
        if len(alone) == 1 and len(condition["ranking"]) > 1:
            return name_of(alone[0])
    return ""


def own_methods(results, built_in):
    """{method: the names in it that are labels or not built in}; `built_in`: the program's own samplers and filters."""
    own = {}
    for entry in results:
        names = [entry.get(kind, "") for kind in ("sampler_name", "filter_name")]
        found = [label for name, label in zip(names, (entry["sampler"], entry["filter"]))
                 if name.split(":")[0] in ARGUMENTS or (built_in and name not in built_in) or is_labelled(name, label)]
        if found:
            own[name_of(entry)] = found
    return own


def is_labelled(name, label):
    """Whether the plan calls a method otherwise than the program does; older files do not say its own name."""
    return bool(name) and re.split(r"[:{ ]", label, maxsplit=1)[0] != name.split(":")[0]


def is_command(name):
    return name.split(":")[0] == "exec"


def choose_methods(wanted, conditions, own):
    """Names in the order of the figure. `conditions`: of one budget."""
    names = list(dict.fromkeys(name_of(entry) for condition in conditions for entry in condition["ranking"]))
    marked = {name.replace(MARK, ""): name for name in names}  # a name is found without the mark, too
    wanted = [marked.get(name.replace(MARK, ""), name) for name in wanted]
    for name in wanted:
        if name not in names:
            raise Failure(f"--method: no '{name}' at this budget; there are {_some_of(names)}", USAGE)
    if len(set(wanted)) > MOST_METHODS:
        raise Failure(f"--method: {len(set(wanted))} methods: a figure has room for {MOST_METHODS}", USAGE)
    if wanted:
        return list(dict.fromkeys(wanted))
    baseline = baseline_of(conditions)
    mine = [name for name in names if name in own and name != baseline]
    chosen = []
    for part in dict.fromkeys(part for name in mine for part in own[name]):  # each of them once, where it is best
        chosen.append(next(name for name in mine if part in own[name]))
    chosen = list(dict.fromkeys(chosen + mine))[:MOST_OWN]
    chosen.sort(key=names.index)
    chosen += [baseline] if baseline else []
    others = [name for name in names if name not in chosen and name not in own]
    return chosen + others[:max(1, USUAL - len(chosen))]


def _some_of(names):
    """As many whole names as an error has room for."""
    count = 1
    while count < len(names) and len("; ".join(names[:count + 1])) <= NAMED:
        count += 1
    rest = len(names) - count
    return "; ".join(names[:count]) + (f"; and {rest} more" if rest else "")


def left_out_text(chosen, conditions):
    """"; not drawn: ..." where the ranking has more."""
    names = dict.fromkeys(name_of(entry) for condition in conditions for entry in condition["ranking"])
    rest = [name for name in names if name not in chosen]
    return f"; not drawn (--method draws them): {list_text(rest, 7)}" if rest else ""

"""What the paper says and what was found of it at full size: blocks of docs/experiments_full.md."""
import re
from collections import Counter

from rare_samples import LIMIT
from statements import in_a_line, kinds_of_change, of_the_paper, statements
from tables import LOST, escaped, pool_title, table

# Words of a verdict, of one statement and of several.
KINDS = {"agrees": ("agrees", "agree"), "mixed": ("is mixed", "are mixed"), "disagrees": ("disagrees", "disagree"), "undecided": ("is undecided", "are undecided")}


def kind(verdict):
    return verdict.replace("*", "").split(",")[0].split(":")[0]


def about(statement):
    """robust, paper or others: whose method the statement is about."""
    if statement.of_preset_paper:
        return "paper"
    return "others" if re.match("(the samples of )?(mitchell|adaptive_wavelet) ", statement.text) else "robust"


def listed(parts):
    return ", ".join(parts[:-1]) + " and " + parts[-1] if len(parts) > 1 else "".join(parts)


def counts(verdicts):
    """'9 agree, 12 are mixed and 3 disagree'"""
    found = Counter(map(kind, verdicts))
    return listed([f"{found[k]} {words[found[k] != 1]}" for k, words in KINDS.items() if found[k]])


def named(pairs):
    return "; ".join(f"{now.chapter}: {now.text.replace('|', '')} ({then.verdict.replace('*', '')} there)" for then, now, _ in pairs) or "none"


def summary(name, pairs):
    """pairs: those of of_the_paper."""
    fresh = [f.verdict for _, _, f in pairs if f]
    both = [p for p in pairs if p[0]]
    gained, lost = ([p for p in both if p[1].agrees == now and p[0].agrees != now] for now in (True, False))
    turned = kinds_of_change([["", then.verdict, now.verdict, ""] for then, now, _ in both])[0]
    return (f"{name}: of {len(pairs)} statements {counts(now.verdict for _, now, _ in pairs)}."
            + (f" On fresh samples {len(fresh)} of them could be asked: {counts(fresh)}." if fresh else "")
            + f" Of {len(both)} that were asked on pictures of 64 x 64 pixels as well, {turned} turned round. Agree now, and did not there: {named(gained)}. "
            f"Agreed there, and do not now: {named(lost)}.")


def split(statement, titles):
    """'2 of 3': on how many of these recordings it held."""
    held, level, reversed_on = statement.on(titles)
    total = held + level + reversed_on
    return f"{held} of {total}" if total else "–"


def losing(statement):
    return sum(float(e.split(" / ")[0]) < 1 - LOST for e in statement.energies.values())


def of_paper(small, full, shares=None):
    """Blocks; small, full: texts of the two pages; shares: those of rare_samples."""
    pairs = of_the_paper(statements(small), statements(full))
    asked_of = {pool for _, now, _ in pairs for pool in now.pools}
    titles = {in_a_line(pool_title(r)): share > LIMIT for r, share in (shares or {}).items()}
    quiet, rare = ([t for t, is_rare in titles.items() if is_rare == wanted and t in asked_of] for wanted in (False, True))
    ours, printed, others = ([p for p in pairs if about(p[1]) == wanted] for wanted in ("robust", "paper", "others"))
    rows = [[f"{now.chapter}: {escaped(now.text)}", then.verdict if then else "–", now.verdict, fresh.verdict if fresh else "–",
             split(now, quiet), split(now, rare), str(losing(now) or "–")] for then, now, fresh in pairs]
    return ["## What the paper says",
            "Each statement counts once, however many chapters make it. *On fresh samples*: the same numbers of samples, judged on samples that did not decide them.",
            summary("About the preset `robust`, which is ours (E1: about both)", ours),
            summary("About the preset `paper`, its equations as printed", printed) if printed else "",
            summary("About other samplers", others) if others else "",
            "*Fireflies* are rare bright samples: a recording has them where the worst 0.1 % of the pixels of uniform samples bear more than "
            f"{100 * LIMIT:.0f} % of relMSE ({', '.join(sorted(rare))}); it has none on {', '.join(sorted(quiet))}. Two columns count the recordings (E1: with each of "
            "two presets) on which a statement held at one budget at least and was reversed at none. The last: on how many recordings the method loses more than "
            f"{100 * LOST:.0f} % of the light, so that its picture is darker than the reference.",
            table(["statement", "64 x 64", "full size", "on fresh samples", "without fireflies", "with fireflies", "losing light"], rows)]

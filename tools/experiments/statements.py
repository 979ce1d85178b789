"""Statements of two generated pages, their verdicts, and which of them changed from one page to the other.

A statement is a line "- STATEMENT: VERDICT. Pool: below at 4 spp. pool: ..." (tables.finding), or one that answers yes or no
recording by recording (E1).
"""
import re
from dataclasses import dataclass, field

from tables import escaped

VERDICT = re.compile(r"^- (?P<text>.+?): (?P<verdict>agrees|\*\*disagrees\*\*|\*\*mixed\*\*|undecided|not measured)"
                     r"(?P<more>, in part not told apart|: not told apart)?[ .](?P<pools>.*)$")
ANSWERS = re.compile(r"^- (?P<text>.+?): (?P<pools>[^:]+: (?:yes|not told apart|\*\*no\*\*)(?:; [^:;]+: (?:yes|not told apart|\*\*no\*\*))*)\.$")
FRESH = " on fresh samples"
# Ours or about rivals, in chapters that otherwise ask what the paper says.
OURS = ("control that only clamps", "the counts of multiscale follow", "mitchell is below uniform", "one region a step", "tiles of", "the preset paper with S",
        "the preset paper with the reciprocal", "the preset paper with both", "the oracle neyman", "is below uniform + directional",
        "is below uniform + nl_means", "uniform samples behind its own filter", FRESH)


@dataclass
class Statement:
    chapter: str
    text: str
    verdict: str
    pools: dict = field(default_factory=dict)     # {recording: what was found on it}
    energies: dict = field(default_factory=dict)  # {recording on which a method loses light: "0.88 / 0.95", energy ratios of first and second}

    def on(self, titles):
        """(recordings of these on which it came out, on which nothing is told apart, on which it did not)"""
        # E1 answers for each preset: "scene S, robust".
        found = [_sign(said) for pool, said in self.pools.items() if re.sub(", (robust|paper)$", "", pool) in titles]
        return found.count(1), found.count(0), found.count(-1)

    @property
    def of_preset_paper(self):
        return "preset paper" in self.text or self.text.startswith("paper: ")

    @property
    def agrees(self):
        return self.verdict.startswith("agrees")

    @property
    def of_the_paper(self):
        return self.chapter.startswith("E") and not any(words in self.text for words in OURS)


def verdict_of(pools):
    """Of all that was found, in the words of tables.finding; None for numbers."""
    said = " ".join(pools.values())
    yes, no, level = (any(w in said for w in words) for words in (("below at", "yes"), ("above at", "**no**"), ("not told apart",)))
    rest = ", in part not told apart" if level else ""
    if yes and no:
        return "**mixed**"
    return f"agrees{rest}" if yes else f"**disagrees**{rest}" if no else "undecided: not told apart" if level else None


def merged(found):
    """{text: Statement} of these, each once: chapters that make the same statement of other recordings or at other budgets are one."""
    one = {}
    for said in found:
        text = said.text.replace(" at 4 samples per pixel and more", "")
        into = one.setdefault(text, Statement("", text, said.verdict))
        into.chapter = ", ".join(dict.fromkeys([*filter(None, into.chapter.split(", ")), said.chapter]))
        for pool, words in said.pools.items():
            into.pools[pool] = "; ".join(dict.fromkeys([*filter(None, [into.pools.get(pool)]), words]))
        into.energies.update(said.energies)
        into.verdict = verdict_of(into.pools) or said.verdict
    return one


def _sign(said):
    """1 where a statement came out on a recording, at some budgets at least, 0 where nothing was told apart, -1 where it did not, None for numbers."""
    words = ((-1, ("above at", "**no**")), (1, ("below at", "yes")), (0, ("not told apart",)))
    return next((sign for sign, texts in words if any(text in said for text in texts)), None)


def in_a_line(pool):
    """A recording's name without the capital letter that a sentence begins with."""
    return pool[0].lower() + pool[1:]


def _of_pools(text):
    """[(recording, what was found on it, energy ratio or "")] of 'Scene S: below at 4, 8 spp (energy 0.91). chess: 20.47.'"""
    return [(in_a_line(pool), said, energy)
            for pool, said, energy in re.findall(r"(\S[^.:]*): (.+?)(?: spp)?(?: \(energy ([^)]*)\))?\.(?: |$)", text)]


def _answered(chapter, match):
    pools = dict(part.rsplit(": ", 1) for part in match["pools"].split("; "))
    return Statement(chapter, match["text"], verdict_of(pools), {in_a_line(p): said for p, said in pools.items()})


def statement(line, chapter=""):
    """The Statement that the line makes, or None."""
    if match := VERDICT.match(line):
        pools = _of_pools(match["pools"])
        return Statement(chapter, match["text"], match["verdict"] + (match["more"] or ""), {pool: said for pool, said, _ in pools},
                         {pool: energy for pool, _, energy in pools if energy})
    match = ANSWERS.match(line)
    return _answered(chapter, match) if match else None


def statements(page):
    """{(chapter, text): Statement} of a generated page."""
    chapter, found = "", {}
    for line in page.splitlines():
        if line.startswith("## "):
            chapter = line[3:].split(":")[0]
        elif said := statement(line, chapter):
            found[chapter, said.text] = said
    return found


def _cell(said, energy):
    """What was found on a recording, short: one word where all budgets agree."""
    words = [part.partition(" at ") for part in said.replace("not told apart", "=").split("; ")]
    short = words[0][0] if len(words) == 1 else "; ".join(f"{word} {budgets}".strip() for word, _, budgets in words)
    return f"{short} ({energy})" if energy else short


def as_table(found):
    """Header and rows of these statements: what was found, recording by recording."""
    pools = list(dict.fromkeys(pool for said in found for pool in said.pools))
    rows = [[escaped(said.text), said.verdict, *(_cell(said.pools[p], said.energies.get(p)) if p in said.pools else "–" for p in pools)]
            for said in found]
    return ["statement", "verdict", *pools], rows


def same_recordings(before, after):
    """What changed on recordings of the same scene: 'scene S: above at 4 -> below at 4'."""
    return [f"{pool}: {said} → {after.pools[pool]}" for pool, said in before.pools.items()
            if pool in after.pools and after.pools[pool] != said]


def change_rows(before, after):
    """[[statement, verdict before, verdict after, what changed on the same scenes]] of statements with another verdict; measured in both."""
    rows = []
    for key, now in after.items():
        then = before.get(key)
        if then and "not measured" not in (then.verdict, now.verdict) and then.verdict != now.verdict:
            rows.append([f"{now.chapter}: {now.text}", then.verdict, now.verdict, "; ".join(same_recordings(then, now)) or "–"])
    return sorted(rows, key=lambda row: row[3] == "–")  # first what does not change by other recordings alone


def _signs(verdict):
    """Which answers a verdict holds: +1 as stated, -1 the other way."""
    return {1, -1} if "mixed" in verdict else {-1} if "disagrees" in verdict else {1} if "agrees" in verdict else set()


def kinds_of_change(rows):
    """Of change_rows, how many say the opposite, how many are decided on one page only, and how many change in part."""
    pairs = [(_signs(then), _signs(now)) for _, then, now, _ in rows]
    opposite = sum(then != now and len(then) == len(now) == 1 for then, now in pairs)
    one_page = sum(not then or not now for then, now in pairs)
    return opposite, one_page, len(rows) - opposite - one_page


def of_the_paper(before, after):
    """[(Statement before or None, Statement after, that on fresh samples or None)], each of the paper's statements once, that were measured after."""
    then, now = (merged(s for s in found.values() if s.verdict != "not measured" and s.chapter.startswith("E")) for found in (before, after))
    return [(then.get(text), said, now.get(text + FRESH)) for text, said in now.items() if said.of_the_paper]

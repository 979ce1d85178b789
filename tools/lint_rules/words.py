"""Plain technical English: words that this project's texts do not use, in comments, docstrings, pages, help and errors.

A file contains, a function returns, a method requires: none of them speaks or tells. A person is named by the part that matters (a user, a
caller, another program). The one word for a `.spool` file is recording.
"""
import io
import re
import tokenize

WORDS = {"nobody": "say what is absent", "somebody": "a user, another program", "anybody": "any user, any program", "whoever": "the caller, the reader",
         "tell": "distinguish, return, contain", "tells": "distinguishes, returns, contains", "told": "distinguished, printed, given",
         "speak": "contain, name", "speaks": "contains, names", "says nothing": "contains nothing known", "dump": "recording", "dumps": "recordings"}
# (path, word): names that a text must use.
ALLOWED = {("docs/glossary.md", "dump"), ("dumps/recording/reference_need.py", "told"), ("lib/experiment/result_table.h", "dump"),
           ("tools/python/spool/recordings.py", "dump")}
FOUND = re.compile(r"(?<![\w./:`{\[<-])(" + "|".join(WORDS) + r")\b(?![/:.(=-]\w|[/(\[\]`}])", re.I)
CODE = re.compile(r"^(```|~~~).*?^\1|^(?: {4}|\t)[^\n]*$|``.*?``|`[^`\n]*`|\]\([^)\n]*\)|<!--.*?-->", re.M | re.S)
COMMENT = re.compile(r"(?:^|\s)//(.*)$|(\"(?:[^\"\\\n]|\\.)*\")", re.M)
# Tests, tables, this list; and files that are being rebuilt, whose words are still to be changed.
SKIPPED = ("tests/", "docs/results/", "tools/lint_rules/words.py")


def blanked(match):
    return re.sub(r"[^\n]", " ", match.group(0))


def prose(path, text):
    """The text with everything that is no prose blanked; lines stay lines."""
    if path.suffix in {".md", ".in"}:
        return CODE.sub(blanked, text)
    if path.suffix == ".py":
        kept = [""] * (text.count("\n") + 2)
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and token.string.lstrip("rbfRBF").startswith('"""')):
                for i, line in enumerate(CODE.sub(blanked, token.string).split("\n")):
                    kept[token.start[0] - 1 + i] += " " + line
        return "\n".join(kept)
    lines = []
    for line in text.split("\n"):
        lines.append(" ".join(a or (b if " " in b else "") for a, b in COMMENT.findall(line)) if "#include" not in line else "")
    return "\n".join(lines)


def words_in(path, text):
    """(line, word) of each word of the list."""
    for number, line in enumerate(prose(path, text).split("\n"), 1):
        for match in FOUND.finditer(line):
            if (str(path), match[1].lower()) not in ALLOWED:
                yield number, match[1]


def check(files):
    for path in files:
        if path.suffix not in {".h", ".cpp", ".py", ".md", ".in", ".js"} or str(path).startswith(SKIPPED):
            continue
        for number, word in words_in(path, path.read_text(encoding="utf-8", errors="replace")):
            yield f"{path}:{number}: '{word}': {WORDS[word.lower()]} (tools/lint_rules/words.py)"

"""Parameters of XML scenes ($name, <default name="..." value="..."/>): which are missing, and which there are."""
import os
import re


def undefined(source, first, definitions):
    """Names that the scene uses and does not define, in its order; first: the one that Mitsuba stumbled on."""
    text = _text(source, set())
    defined = {*_defaults(text), *definitions}
    names = [name for name in dict.fromkeys(re.findall(r"\$(\w+)", text)) if name not in defined]
    return names if first in names else [first, *names]


def missing_line(source, names):
    several = len(names) > 1
    return "%s: uses the parameter%s %s without a value: give %s" % (
        source, "s" if several else "", ", ".join(names), " ".join("-D %s=VALUE" % name for name in names))


def unknown_line(source, names):
    known = sorted(_defaults(_text(source, set())))
    return "-D %s: %s has no such parameter: %s" % (names[0], source, "it has " + ", ".join(known) if known else "it has none")


def _defaults(text):
    return set(re.findall(r'<default\s+name="([^"]+)"', text))


def _text(path, seen):
    """Of the file and of those it includes, without comments; a file that is not there is none of this module's business."""
    if path in seen or not os.path.isfile(path):
        return ""
    seen.add(path)
    with open(path, encoding="utf-8", errors="replace") as stream:
        text = re.sub(r"<!--.*?-->", "", stream.read(), flags=re.DOTALL)
    included = re.findall(r'<include\s+filename="([^"]+)"', text)
    return "\n".join([text] + [_text(os.path.join(os.path.dirname(path), name), seen) for name in included])

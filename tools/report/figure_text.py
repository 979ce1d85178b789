"""Text of the figures: fonts, names as papers write them, and lines that are measured before they are set."""

import io
import math
import re
from functools import cache
from pathlib import Path

import matplotlib
from matplotlib import pyplot
from matplotlib.font_manager import findfont, get_font

pyplot.switch_backend("agg")

WIDTHS = {1: 3.33, 2: 7.0}  # inches: one column of a paper of two, and both
STYLE = {"font.family": ["STIXGeneral", "DejaVu Serif"], "mathtext.fontset": "stix", "font.size": 8, "pdf.fonttype": 42,
         "ps.fonttype": 42, "svg.fonttype": "path", "svg.hashsalt": "spool", "axes.linewidth": 0.6, "lines.linewidth": 1.1,
         "lines.markersize": 4, "legend.fontsize": 7.5, "axes.titlesize": 8, "figure.dpi": 300,
         "axes.unicode_minus": False}
ANY = 999  # lines
LEADING = 1.1
LONGEST_WORD = 20  # letters; a longer one may be broken after every WORD
WORD = 7
LATEX = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}",
         ">": r"\textgreater{}", "|": r"\textbar{}", "`": r"\textasciigrave{}", "-": "-{}"}


def style(font=""):
    """`font`: "latex", or "latex:PACKAGE" where the paper loads a font by a package."""
    if not font:
        return STYLE
    package = font.partition(":")[2]
    preamble = r"\usepackage[T1]{fontenc}" + (rf"\usepackage{{{package}}}" if package else "")
    return {**STYLE, "text.usetex": True, "font.family": "serif", "font.serif": [], "text.latex.preamble": preamble}


def latex(text):
    return "".join(LATEX.get(c, "\\" + c if c in "{}$&#_%" else c) for c in printable(text))


def breakable(text):
    """A name in LaTeX that may be broken after its marks, and a word of it that is longer than any of a language."""
    parts = []
    for word in re.findall(r"[^ ,{}:;/_=-]+|.", printable(text)):
        step = WORD if len(word) > LONGEST_WORD else LONGEST_WORD
        pieces = [latex(word[i:i + step]) for i in range(0, len(word), step)]
        parts.append(r"\allowbreak{}".join(pieces) + (r"\allowbreak{}" if word in ",{}:;/_=-" else ""))
    return "".join(parts)


@cache
def has_glyph(c):
    return any(get_font(findfont(family, fallback_to_default=False)).get_char_index(ord(c)) for family in STYLE["font.family"])


def drawable(text):
    """What no font of the figures has is an escape: no letter of a name is left blank."""
    return "".join(c if has_glyph(c) else f"\\u{ord(c):04x}" for c in printable(text))


def printable(text):
    """One line without control characters, which neither LaTeX nor XML can hold."""
    return "".join(c if c.isprintable() else " " for c in text)


def literal(text):
    """No text of a file is read as mathematics or as a command."""
    if matplotlib.rcParams["text.usetex"]:
        return latex(text)
    return drawable(text).replace("$", r"\$")


def extent(figure, text, size):
    """Width and height in inches. LaTeX's roman is narrower than what is measured for it here."""
    lines = [drawable(line).replace("$", r"\$") for line in text.split("\n")]
    artist = figure.text(0, 0, "\n".join(lines), fontsize=size, linespacing=LEADING, usetex=False)
    box = artist.get_window_extent(figure.canvas.get_renderer())
    artist.remove()
    return box.width / figure.dpi, box.height / figure.dpi


def broken(figure, text, width, size, lines, within=False):
    """`text` as at most that many lines of at most that width, not yet literal; None where it does not fit. Words end
    before a + and after marks, but not within 2.4e-4; with `within` also anywhere."""
    parts = [""]
    for c in drawable(text):
        if c == "+" or (parts[-1] and parts[-1][-1] in " ,{}:;/_=-" and c not in " ,{}:;/_=-"
                        and not re.search(r"\de-$", parts[-1])) or within and len(parts[-1]) > 7:
            parts.append("")
        parts[-1] += c
    found, fits = [""], lambda line: extent(figure, line.strip(), size)[0] <= width
    for part in filter(None, parts):
        if part.startswith("+") and found[-1] and lines > 1 and not within:
            found.append(part)  # sampler, filter
        elif fits(found[-1] + part):
            found[-1] += part
        else:
            found.append(part)
        if len(found) > lines or not fits(found[-1]):
            return None
    return "\n".join(line.strip() for line in found)


def fitted(figure, text, width, sizes, lines):
    """(literal text, size) of the first size at which the text fits, on as few lines as do; None where none does."""
    for size in sizes:
        for count in range(1, lines + 1):
            found = broken(figure, text, width, size, count)
            if found is not None:
                return "\n".join(map(literal, found.split("\n"))), size
    return None


def whole(figure, text, width, size):
    """`text` on as many lines as it takes, words broken where they must be."""
    tries = (broken(figure, text, width, size, lines, lines == ANY) for lines in (1, 2, 3, 9, ANY))
    return "\n".join(map(literal, next((found for found in tries if found is not None), text).split("\n")))


def significant(value, digits=3):
    """So many digits, the last one too where it is 0."""
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    if not value or not math.isfinite(value):
        return f"{value:g}"
    power = int(exponent)
    return f"{value:.{max(0, digits - 1 - power)}f}" if -3 <= power < 5 else f"{mantissa}e{power}"


def tick_text(value, _=None):
    if 0.99e-4 < abs(value) < 1e5:
        return f"{value:g}"
    exponent = math.floor(math.log10(value) + 1e-9)
    factor = f"{value / 10 ** exponent:g}"
    return f"$10^{{{exponent}}}$" if factor == "1" else rf"${factor}\cdot 10^{{{exponent}}}$"


def save(figure, output, kinds=("pdf", "svg", "png")):
    """The figure as files of these kinds, the same bytes each time."""
    undated = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": {"Software": None}}
    written = []
    for kind in kinds:
        made = io.BytesIO()  # a full disk is then an error of this write, not of matplotlib's clean-up
        figure.savefig(made, format=kind, metadata=undated[kind], dpi=300)
        written.append(Path(f"{output}.{kind}"))
        written[-1].write_bytes(made.getvalue())
    pyplot.close(figure)
    return written

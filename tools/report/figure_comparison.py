"""Recordings as rows: the reference with frames, the same windows of every method, error maps, numbers."""

from typing import NamedTuple

import numpy as np
from matplotlib import pyplot
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, NullLocator

from tools.report.exr_image import read_exr, rgb, single
from tools.report.figure_layout import GAP, lay_out
from tools.report.figure_text import LEADING, WIDTHS, extent, fitted, save, style, whole
from tools.report.figure_windows import choose_windows, inside
from tools.report.result_images import exposure_and_mean, tone_mapped

# Colour and dash: distinct in grey, too.
FRAMES = (("#e69f00", "-"), ("#0072b2", "--"), ("#56b4e9", (0, (1, 1))), ("#009e73", "-."))
HEAD_SIZES = (7.5, 7, 6.5, 6, 5.5)
FOOT_SIZES = (7, 6.5, 6, 5.5, 5, 4.5)
LINE = 1.22 / 72  # inches of a line for each point of its size
TALLEST = 7.2  # inches of a page, which has a caption, too
TALLEST_ALONE = 4.5  # of a figure of one recording


class Shown(NamedTuple):
    method: str
    lines: list  # of numbers
    bold: bool  # the best, separated from every other
    paths: dict  # picture: file


class Block:
    """A recording: its pictures, read."""

    def __init__(self, label, methods, crops):
        self.label, self.methods = label, methods  # {place: Shown}
        self.estimates = {place: rgb(read_exr(shown.paths["estimate"])) for place, shown in methods.items()}
        path = next((shown.paths["reference"] for shown in methods.values() if "reference" in shown.paths), None)
        self.judged = path is not None
        self.reference = rgb(read_exr(path)) if path else self.estimates[max(self.estimates)]
        self.exposure = exposure_and_mean(self.reference)[0]
        self.height, self.width = self.reference.shape[:2]
        images = [image for image in self.estimates.values() if image.shape == self.reference.shape]
        self.windows = (inside(crops, self.reference.shape, label) if crops else
                        choose_windows(images, self.reference, self.exposure))

    def errors(self):
        return {place: np.maximum(single(read_exr(shown.paths["squared_error"])), 0.0)
                for place, shown in self.methods.items() if "squared_error" in shown.paths}


class Comparison:
    def __init__(self, blocks, names, head_line, column):
        self.blocks, self.names = blocks, names  # of every place; the reference comes last
        self.width = WIDTHS[column]
        self.figure = pyplot.figure(figsize=(self.width, 4.0))
        self.errors = blocks[0].errors() if len(blocks) == 1 else {}
        self.norm = self._norm() if self.errors else None
        self.keyed = False
        self.edge = 0.03
        self._lay_out(head_line)
        self._set_texts()
        self.figure.set_size_inches(self.width, self.height)

    def _lay_out(self, head_line):
        first = self.blocks[0]
        inner = self.width - 2 * self.edge
        self.head_line, self.head_size = fitted(self.figure, head_line, inner, (8, 7, 6, 5), 3) or (
            whole(self.figure, head_line, inner, 5), 5)
        self.top = self.edge + LINE * self.head_size * (1 + self.head_line.count("\n")) + 0.02
        tallest = TALLEST_ALONE if len(self.blocks) == 1 else TALLEST
        aspect = max(block.width / block.height for block in self.blocks)
        shapes = [window.width / window.height for window in first.windows]
        head, foot = 3 * LINE * 7, 2 * LINE * 7 + 0.06
        tiles = len(self.names) + any(block.judged for block in self.blocks)
        self.layout = lay_out(inner, (tallest - self.top) / len(self.blocks), tiles, aspect, shapes, bool(self.errors), head,
                              foot)
        self.left = (inner - self.layout.width) / 2

    def _set_texts(self):
        inner = self.width - 2 * self.edge
        self.tile_heads = [self._fit(name, self.layout.tile) for name in self.names]
        if None in self.tile_heads:
            self.keyed = True
            self.tile_heads = [(str(i + 1), 7.5) for i in range(len(self.names))]
        self.tile_heads.append(self._fit("reference", self.layout.tile) or ("reference", 4.5))
        fits = [fitted(self.figure, block.label, self.layout.thumb[0], HEAD_SIZES[:3], 2) for block in self.blocks]
        self.above = None in fits  # labels stand in a line of their own, over all of their block
        self.labels = fits if not self.above else [
            self._fit(block.label, self.layout.width) or (whole(self.figure, block.label, inner, 5), 5) for block in self.blocks]
        self.feet = [{place: [self._foot(line) for line in shown.lines] for place, shown in block.methods.items()}
                     for block in self.blocks]
        self.foot = 0.06 + max(sum(map(_height, lines)) for feet in self.feet for lines in feet.values())
        keys = [whole(self.figure, f"{i + 1}: {name}", inner, 7) for i, name in enumerate(self.names)] if self.keyed else []
        self.keys = "\n".join(keys)
        self.height = self.top + sum(map(self._height_of, range(len(self.blocks)))) + self.edge + (
            extent(self.figure, self.keys, 7)[1] + 0.08 if keys else 0.0)

    def _fit(self, text, width):
        return fitted(self.figure, text, width - 0.02, HEAD_SIZES, 3)

    def _foot(self, line):
        width = self.layout.tile - 0.02
        return fitted(self.figure, line, width, FOOT_SIZES, 2) or (whole(self.figure, line, width, 4.5), 4.5)

    def _line_of(self, block):
        """Height of a label that stands above its block."""
        return _height(self.labels[block]) + 0.06 if self.above else 0.0

    def _is_named(self, block):
        """Methods are named over the first block, and over every row of tiles where they take several."""
        return block == 0 or len(self.layout.rows) > 1

    def _head_of(self, block, row):
        heads = self.tile_heads if self._is_named(block) else []
        return 0.05 + max(map(_height, [*heads, *([self.labels[block]] if row == 0 and not self.above else [])]), default=0.0)

    def _height_of(self, block):
        return self._line_of(block) + sum(self._head_of(block, row) + self.layout.row(self.foot)
                                          for row in range(len(self.layout.rows)))

    def axes(self, left, top, width, height):
        axes = self.figure.add_axes(((self.edge + self.left + left) / self.width, 1 - (top + height) / self.height, width / self.width,
                                     height / self.height))
        axes.set_xticks([])
        axes.set_yticks([])
        return axes

    def text(self, left, top, text_and_size, **more):
        """`left`: the middle of the text."""
        text, size = text_and_size
        more = {"ha": "center", "va": "top", "linespacing": LEADING, **more}
        self.figure.text((self.edge + self.left + left) / self.width, 1 - top / self.height, text, fontsize=size, **more)

    def draw(self):
        self.text(self.width / 2 - self.edge - self.left, self.edge, (self.head_line, self.head_size))
        top = self.top
        for index, block in enumerate(self.blocks):
            if self.above:
                self.text(self.layout.width / 2, top + 0.06, self.labels[index])
                top += self._line_of(index)
            for row, places in enumerate(self.layout.rows):
                top += self._head_of(index, row)
                left = self.layout.start(row)
                if row == 0:
                    self._thumbnail(block, None if self.above else self.labels[index], left - 2 * GAP - (self.layout.side + self.layout.thumb[0]) / 2, top)
                for place in places:
                    self._tile(block, index, place, left, top)
                    left += self.layout.tile + GAP
                top += self.layout.row(self.foot)
        if self.keys:
            self.text(-self.left, top + 0.03, (self.keys, 7), ha="left")

    def _thumbnail(self, block, label, left, top):
        wide, high = self.layout.thumb
        if label:
            self.text(left + wide / 2, top - 0.03, label, va="bottom")
        axes = self.axes(left, top, wide, max(high, min(self.layout.windows, wide * block.height / block.width)))
        axes.set_anchor("N")
        axes.imshow(tone_mapped(block.reference, block.exposure), interpolation=_resampling(block.width, wide))
        for window, (colour, dash) in zip(block.windows, FRAMES):
            axes.add_patch(Rectangle((window.x - 0.5, window.y - 0.5), window.width, window.height, fill=False,
                                     edgecolor=colour, linestyle=dash, linewidth=1.2, clip_on=False, zorder=5))
        if self.errors:
            self._colour_bar(left + wide / 2, top + self.layout.windows + GAP)

    def _norm(self):
        """Four decades below what few pixels exceed, the same for all methods."""
        values = np.concatenate([error[np.isfinite(error)].ravel() for error in self.errors.values()])
        high = max(float(np.quantile(values, 0.995)) if values.size else 1.0, 1e-30)
        return LogNorm(1e-4 * high, high)

    def _colour_bar(self, middle, top):
        norm, length = self.norm, min(1.6, 0.8 * self.layout.side)
        powers = [k for k in range(-40, 40) if norm.vmin <= 10.0 ** k <= norm.vmax]
        powers = powers if length > 1.2 else powers[::len(powers) - 1 or 1]
        bar = self.axes(middle - length / 2, top + 0.22, length, 0.08)
        self.figure.colorbar(ScalarMappable(norm, "inferno"), cax=bar, orientation="horizontal")
        bar.xaxis.set_major_locator(FixedLocator([10.0 ** k for k in powers]))
        bar.xaxis.set_minor_locator(NullLocator())
        bar.set_xticklabels([f"$10^{{{k}}}$" for k in powers], fontsize=6)
        bar.tick_params(pad=1.5, length=2)
        self.text(middle, top + 0.17, ("squared error", 6.5), va="bottom")

    def _tile(self, block, index, place, left, top):
        is_reference = place == len(self.names)
        image = block.reference if is_reference else block.estimates.get(place)
        tile, middle = self.layout.tile, left + self.layout.tile / 2
        if self._is_named(index):
            self.text(middle, top - 0.03, self.tile_heads[place], va="bottom")
        if image is None or (is_reference and not block.judged):
            return
        x, y = left, top
        for window, (colour, dash) in zip(block.windows, FRAMES):
            shape = self.layout.size if self.layout.beside else self.layout.size * window.height / window.width
            wide, high = (shape * window.width / window.height, shape) if self.layout.beside else (tile, shape)
            axes = self.axes(x, y, wide, high)
            axes.imshow(tone_mapped(window.of(image), block.exposure), interpolation=_resampling(window.width, wide))
            for spine in axes.spines.values():
                spine.set(edgecolor=colour, linestyle=dash, linewidth=1.2)
            x, y = (x + wide + GAP, y) if self.layout.beside else (x, y + high + GAP)
        below = top + self.layout.windows
        if not is_reference and self.layout.maps:
            below += GAP
            error = self.errors.get(place)
            if error is not None:
                norm = self.norm
                axes = self.axes(left, below, tile, self.layout.maps)
                axes.imshow(np.maximum(error, norm.vmin), norm=norm, cmap="inferno",
                            interpolation=_resampling(error.shape[1], tile))
            below += self.layout.maps
        below += 0.05
        for i, line in enumerate(self.feet[index].get(place, [])):
            self.text(middle, below, line, fontweight="bold" if block.methods[place].bold and i == 0 else "normal")
            below += _height(line)


def draw_comparison(blocks, names, head_line, output, column=0, font=""):
    """Files written."""
    with pyplot.rc_context(style(font)):
        comparison = Comparison(blocks, names, head_line, column or 2)
        comparison.draw()
        return save(comparison.figure, output)


def _height(text_and_size):
    text, size = text_and_size
    return LINE * size * (1 + text.count("\n"))


def _resampling(pixels, inches):
    """Pixels stay squares where they are to be seen; a picture of more than a page has is averaged."""
    return "nearest" if pixels < 150 * inches else "antialiased"

"""Where the parts of a comparison stand: pure arithmetic, in inches."""

from typing import NamedTuple

GAP = 0.04
SMALLEST = 0.45  # a window below it is made larger by another row, where the page has room
LARGEST = 1.6
THUMB_SHARE = 0.36  # of the page's width
KEY = 0.7  # inches: the least width of the scale of error maps, with its numbers


class Layout(NamedTuple):
    beside: bool  # the windows of a method stand beside each other, not below
    size: float  # of a window: its width where they stand below each other, else its height
    rows: list  # [[place of a tile]]; the first row begins with the thumbnail
    thumb: tuple  # width, height
    side: float  # width of what stands left of the first row: the thumbnail and the scale below it
    tile: float  # width
    windows: float  # height of all windows of a tile
    maps: float  # height of an error map; 0 without
    width: float  # of the longest row; they all end at one edge, so that tiles stand below each other

    def row(self, foot):
        """Height of a row of tiles with the numbers below it, without what stands above."""
        return self.windows + (GAP + self.maps if self.maps else 0.0) + foot

    def start(self, row):
        """Where its first tile begins, from the left of the longest row; in row 0 the thumbnail stands before it."""
        count = len(self.rows[row])
        return self.width - count * self.tile - (count - 1) * GAP

    def is_even(self):
        """No last row of one tile, with nothing beside it."""
        return len(self.rows) == 1 or len(self.rows[-1]) > 1


def lay_out(width, height, tiles, aspect, shapes, with_maps, head, foot):
    """The layout with the largest windows; one row where they do not become too small by it. `aspect`: width by height of
    the picture; `shapes`: those of the windows; `head`, `foot`: inches of text above and below a row."""
    def largest(rows, even, beside):
        layouts = (_at(step / 100, beside, width, tiles, aspect, shapes, with_maps) for step in range(int(100 * LARGEST), 19, -1))
        return next((layout for layout in layouts if layout and len(layout.rows) <= rows and layout.is_even() >= even
                     and len(layout.rows) * (head + layout.row(foot)) <= height), None)

    candidates = []
    for even in (True, False):
        for rows in range(1, tiles + 2):
            for beside in (False,) if with_maps else (False, True):
                found = largest(rows, even, beside)
                if found and found.size >= SMALLEST:
                    return found
                if found:
                    candidates.append(found)
    return max(candidates, key=lambda layout: layout.size, default=None) or _at(
        0.2, False, width, tiles, aspect, shapes, with_maps)


def _at(size, beside, width, tiles, aspect, shapes, with_maps):
    """None where a tile is wider than the page."""
    gaps = GAP * (len(shapes) - 1)
    tile = size * sum(shapes) + gaps if beside else size
    windows = size if beside else sum(size / shape for shape in shapes) + gaps
    wide = min(windows * aspect, THUMB_SHARE * width)
    side = max(wide, KEY) if with_maps else wide
    rows, left, longest = [[]], side + 2 * GAP, 0.0
    for place in range(tiles):
        if left + tile > width + 1e-9:
            rows.append([])
            left = 0.0
        rows[-1].append(place)
        left += tile + GAP
        longest = max(longest, left - GAP)
    if tile > width:
        return None
    return Layout(beside, size, rows, (wide, wide / aspect), side, tile, windows, tile / aspect if with_maps else 0.0, longest)

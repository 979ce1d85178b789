"""What text a figure draws and where: for tests that none lies outside the page or over another."""

from matplotlib.text import Text

SLACK = 0.4 / 72  # inches: antialiasing, and the leading that extents have


def recorded(monkeypatch):
    """A list that grows by (page, text, box in inches, of its page: axes that it does not belong to) while figures are
    drawn, in every format by the extents of that format."""
    found, draw = [], Text.draw

    def watched(self, renderer, *arguments, **more):
        draw(self, renderer, *arguments, **more)
        if self.get_visible() and self.get_text().strip():
            scale = self.figure.dpi
            box = self.get_window_extent(renderer)
            found.append((self.figure, type(renderer).__name__ + str(id(renderer)), self, [v / scale for v in box.extents]))

    monkeypatch.setattr(Text, "draw", watched)
    return found


def strays(found):
    """One line for each text that lies outside its page, over another text or over a picture that is not its own."""
    problems, pages = [], {}
    for figure, renderer, text, box in found:
        pages.setdefault((id(figure), renderer), (figure, []))[1].append((text, box))
    for (_, renderer), (figure, texts) in pages.items():
        width, height = figure.get_size_inches()
        for i, (text, box) in enumerate(texts):
            name = repr(text.get_text()[:60])
            if box[0] < -SLACK or box[1] < -SLACK or box[2] > width + SLACK or box[3] > height + SLACK:
                problems.append(f"{renderer}: {name} outside {width:.2f} x {height:.2f}: {[round(v, 2) for v in box]}")
            problems += [f"{renderer}: {name} over {other.get_text()[:60]!r}" for other, there in texts[i + 1:]
                         if other is not text and _meet(box, there)]
            for axes in figure.axes:
                there = [v / figure.dpi for v in axes.get_window_extent().extents]
                if axes.get_visible() and _meet(box, there):
                    problems.append(f"{renderer}: {name} over a picture")
    return problems


def _meet(a, b):
    return min(a[2], b[2]) - max(a[0], b[0]) > SLACK and min(a[3], b[3]) - max(a[1], b[1]) > SLACK

"""One figure of a recording: the reference with two frames, the same windows of every method, error maps, numbers."""

import numpy as np
from matplotlib import pyplot
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.patches import Rectangle

from draw_curves import STYLE, literal, save
from exr_image import read_exr, rgb, single
from inset_windows import choose_windows
from result_images import tone_mapped

FRAMES = (("#e69f00", "-"), ("#0072b2", "--"))  # colour and dash: told apart in grey, too


def draw_comparison(panels, reference_path, exposure, output):
    """`panels`: [(name, lines of numbers, bold, {picture: path})]. Files written."""
    estimates = [rgb(read_exr(paths["estimate"])) for _, _, _, paths in panels]
    reference = rgb(read_exr(reference_path)) if reference_path else estimates[-1]
    errors = [single(read_exr(paths["squared_error"])) if "squared_error" in paths else None for _, _, _, paths in panels]
    windows = choose_windows(estimates[0], estimates[-1], reference)
    height, width = reference.shape[:2]
    columns = len(panels) + (1 if reference_path else 0)
    cell = 7.0 / (columns + 2.15)
    big = 2 * cell
    with pyplot.rc_context(STYLE):
        rows = 2 * cell + cell * height / width + 0.7
        figure = pyplot.figure(figsize=(7.0, rows))

        def place(left, top, wide, high):
            axes = figure.add_axes((left / 7.0, 1 - (top + high) / rows, wide / 7.0, high / rows))
            axes.set_xticks([])
            axes.set_yticks([])
            return axes

        top = 0.3
        shown = min(big, big * height / width)
        axes = place(0.0, top, shown * width / height, shown)
        axes.imshow(tone_mapped(reference, exposure), interpolation="nearest")
        axes.set_title("reference" if reference_path else literal(panels[-1][0]))
        for window, (colour, dash) in zip(windows, FRAMES):
            axes.add_patch(Rectangle((window.x - 0.5, window.y - 0.5), window.width, window.height, fill=False,
                                     edgecolor=colour, linestyle=dash, linewidth=1.4))
        images = list(zip([panel[0] for panel in panels], estimates))
        if reference_path:
            images.append(("reference", reference))
        left = big + 0.15 * cell
        for column, (name, image) in enumerate(images):
            for row, (window, (colour, dash)) in enumerate(zip(windows, FRAMES)):
                axes = place(left + column * cell, top + row * cell, 0.96 * cell, 0.96 * cell)
                axes.imshow(tone_mapped(window.of(image), exposure), interpolation="nearest")
                for spine in axes.spines.values():
                    spine.set(edgecolor=colour, linestyle=dash, linewidth=1.4)
                if row == 0:
                    axes.set_title(_broken(name), fontsize=6.5)
        mean = float(np.mean(reference[np.isfinite(reference)]))
        norm = LogNorm(1e-5 * max(mean, 1e-12) ** 2, max(mean, 1e-12) ** 2)
        for column, ((name, lines, bold, _), error) in enumerate(zip(panels, errors)):
            axes = place(left + column * cell, top + 2 * cell, 0.96 * cell, 0.96 * cell * height / width)
            if error is not None:
                axes.imshow(np.maximum(error, norm.vmin), norm=norm, cmap="inferno", interpolation="nearest")
            for i, line in enumerate(lines):
                axes.text(0.5, -0.06, "\n" * i + line, transform=axes.transAxes, ha="center", va="top", fontsize=5.8,
                          fontweight="bold" if bold and i == 0 else "normal")
        bar = place(0.1 * cell, top + 2 * cell + 0.35 * cell * height / width, 1.7 * cell, 0.1)
        figure.colorbar(ScalarMappable(norm, "inferno"), cax=bar, orientation="horizontal")
        bar.set_title("squared error", fontsize=6.5)
        bar.tick_params(labelsize=6)
        return save(figure, output)


def _broken(name):
    """A method on two lines: sampler, filter."""
    return literal(name).replace(" + ", "\n+ ", 1)

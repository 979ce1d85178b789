"""Images beside each other, in a notebook and in a file: the viewer of the report."""
from __future__ import annotations

import html
import operator
import os
import subprocess
import sys
import warnings
from collections.abc import Iterable, Mapping

import numpy as np

from . import _core
from .arguments import absolute, flag, number, text, wrong
from .arguments import path as path_of
from .cells import name_of
from .error import SpoolError
from .images import image_array
from .own_methods import Method
from .recordings import Dump, Recording, Samples, recording_of
from .steps import Reconstruction, Selection, reconstruct, replay

_HERE = os.path.dirname(os.path.realpath(__file__))
_UNTRUSTED = "The viewer is a script: JupyterLab shows it once the notebook is trusted (Trust Notebook)."


class Page:
    """What a notebook shows as a cell of its own; `html` is a page that needs nothing else, save() writes it."""

    def __init__(self, page: str, height: int, summary: str):
        self.html, self._height, self._summary = page, height, summary

    def __repr__(self):
        return f"<spool.Page of {self._summary}, {len(self.html) / 1e6:.1f} MB>"

    def _repr_html_(self):
        # A document of its own, without the rights of the notebook's: cells share no name and no style.
        return (f'<iframe sandbox="allow-scripts" title="Spool: {html.escape(self._summary)}" srcdoc="{html.escape(self.html)}" '
                f'style="width: 100%; height: {self._height}px; border: 0; resize: vertical; overflow: auto">{_UNTRUSTED}</iframe>')

    def save(self, path: str | os.PathLike, *, force: bool = False) -> None:
        """Writes the page; a file that exists stays unless `force`."""
        _core.write_text(text("path", path_of("path", path)), self.html, flag("force", force))


def show(images, *, reference=None, crops: Iterable = (), title: str = "", exposure: float | None = None,
         max_mb: float = 16.0) -> Page:
    """Images beside each other: flip, split, zoom, exposure, pixel values; with a reference errors and maps of them.

    `images`: {name: image}, a list or one. An image is an array [y][x][3] or [y][x] of linear values, the path of an
    EXR, a Selection, a Reconstruction, or a recording (its mean). `reference`: one of these; of a recording its reference.
    `crops`: (x, y, width, height) to enlarge, else where images differ most. `exposure`: EV, else that of the reference or
    first image. `max_mb`: megabytes of images; larger ones are shrunk, and the page says so.
    """
    files: list = []  # (path, where its pixels lie)
    named = {name: _array_of(image, name, files) for name, image in _named(images).items()}
    judge = None if reference is None else _reference_of(reference, files)
    _core.check_windows(files)
    entries = [(name, "", 0.0, image, None, None, None) for name, image in named.items()]
    return _page(entries, judge, text("title", title), _crops(crops), exposure, max_mb, f"{len(named)} images" if len(named) > 1 else "an image")


def view(samples: Samples, *, sampler="uniform", filter="box", spp=None, reference=None, seed: int = 0, order: str = "recorded",
         crops: Iterable = (), title: str = "", exposure: float | None = None, max_mb: float = 16.0) -> Page:
    """Samplers and filters, your own functions too, at several budgets: the viewer with a slider.

    `sampler`, `filter`: one or a list, names or functions; uniform and box are there besides. `spp`: budgets (four, each
    twice the one before, up to a quarter of the samples). All is computed now: the page asks nothing later. `reference`
    as of show(), else the recorded one.
    """
    recording = recording_of(samples)
    samplers, filters = _methods("uniform", sampler), _methods("box", filter)
    judge = _reference_of(reference) if reference is not None else _recorded_reference(recording)
    budgets = _budgets(spp, recording.spp)
    entries = []
    for budget in budgets:
        for sampler_name, one in samplers.items():
            selection = replay(recording, one, budget, seed=seed, order=order)
            for filter_name, other in filters.items():
                made = reconstruct(recording, selection, other, seed=seed, order=order, whole=True)
                level = None if made.level is None else np.ascontiguousarray(made.level, np.float64)
                entries.append((sampler_name, filter_name, float(budget), np.ascontiguousarray(made.image, np.float64),
                                selection.counts.astype(np.int64), level, made.dominant_direction))
    return _page(entries, judge, text("title", title) or _text(name_of(recording)), _crops(crops), exposure, max_mb,
                 f"{len(samplers) * len(filters)} methods at {len(budgets)} budgets")


def _page(entries, reference, title, crops, exposure, max_mb, summary):
    planes = _core.shown(entries, reference, title, crops, None if exposure is None else number("exposure", exposure), number("max_mb", max_mb))
    aspect = entries[0][3].shape[0] / entries[0][3].shape[1]
    faces = 3 if entries[0][1] else len(entries) + (reference is not None)
    columns = min(faces, 4)  # of a cell of about 900 pixels
    height = -(-faces // columns) * (900 / columns * aspect + 30) + 480
    return Page(_generated(planes), int(min(max(height, 520), 1100)), summary)


def _generated(planes):
    """The page, made by the report's own script in a Python of its own: its modules have ordinary names."""
    places = [os.environ.get("SPOOL_REPORT"), os.path.join(_HERE, "share", "spool", "tools", "report"),
              os.path.join(_HERE, "..", "..", "report")]
    script = next((path for path in (os.path.join(place, "run.py") for place in places if place) if os.path.exists(path)), None)
    if script is None:
        raise SpoolError("io", "run.py: not beside the package: set SPOOL_REPORT to the folder that holds it")
    python = os.environ.get("SPOOL_PYTHON") or sys.executable or "python3"
    try:
        done = subprocess.run([python, script, "show_page"], input=planes, capture_output=True, check=False)
    except OSError as reason:
        raise SpoolError("io", f"{python}: {reason.strerror}: set SPOOL_PYTHON to a Python 3 that has numpy") from None
    if done.returncode != 0:
        said = done.stderr.decode("utf-8", "replace").strip().splitlines() or [f"{python} ended with code {done.returncode}"]
        raise SpoolError.of_code(done.returncode if 1 <= done.returncode <= 4 else 2, f"show: {said[-1]}")
    return done.stdout.decode("utf-8")


def _named(images):
    """{name as it can be written: image}, none of them lost to another of its name."""
    if isinstance(images, Mapping):
        pairs = list(images.items())
    else:
        listed = images if isinstance(images, (list, tuple)) else [images]
        pairs = [(_name_of(image, i), image) for i, image in enumerate(listed)]
    named = {}
    for i, (name, image) in enumerate(pairs):
        name = _text(name)
        while name in named:
            name += f" ({i + 1})"
        named[name] = image
    return named


def _name_of(image, place):
    if isinstance(image, (str, os.PathLike)):
        return os.path.splitext(os.path.basename(os.fspath(image)))[0]
    return f"image {place + 1}"


def _array_of(image, name, files=None):
    if isinstance(image, (Selection, Reconstruction)):
        image = image.image
    elif isinstance(image, (str, os.PathLike)):
        path = absolute(text(name, os.fspath(image)))
        image, remark, windows = _core.read_image(path)
        if files is not None:
            files.append((path, windows))
        if remark:
            warnings.warn(remark, stacklevel=4)
    elif isinstance(image, (Dump, Recording)):
        image = reconstruct(image, None, "box")
    return image_array(image, name)


def _reference_of(reference, files=None):
    if isinstance(reference, (Dump, Recording)):
        found = _recorded_reference(reference)
        if found is None:
            raise SpoolError("usage", f"reference: {reference.source.name} has none: give an image")
        return found
    return _array_of(reference, "reference", files)


def _recorded_reference(recording):
    if isinstance(recording, Recording):
        found = recording.arrays.get("reference")
    else:
        found = recording.pixel("reference") if "reference" in recording.layers else None
    return None if found is None else image_array(found, "reference")


def _methods(first, given):
    """{label: method}, `first` before what was given."""
    given = [given] if isinstance(given, (str, Method)) or not isinstance(given, (list, tuple)) else list(given)
    named = {}
    for method in [first, *(method for method in given if not isinstance(method, str) or method != first)]:
        label = method.label if isinstance(method, Method) else str(method)
        while label in named:
            label += "'"
        named[label] = method
    return named


def _budgets(spp, capacity):
    if spp is None:
        return sorted({max(1, capacity // 4 >> i) for i in range(4)})
    several = isinstance(spp, (list, tuple)) or (isinstance(spp, np.ndarray) and spp.ndim > 0)
    budgets = sorted({number("spp", budget) for budget in (spp if several else [spp])})
    if not budgets:
        raise SpoolError("usage", "spp: no budget given")
    return budgets


def _crops(crops):
    made = []
    if not isinstance(crops, Iterable):
        raise wrong("crops", crops, "no list of (x, y, width, height)")
    for crop in crops:
        try:
            x, y, width, height = (operator.index(value) for value in crop)
        except (TypeError, ValueError, OverflowError):
            raise wrong("crops", crop, "not (x, y, width, height)") from None
        if max(map(abs, (x, y, width, height))) >= 1 << 31:
            raise wrong("crops", crop, "outside of the image")
        made.append((x, y, width, height))
    return made


def _text(name):
    """Any name as text that can be written."""
    return str(name).encode("utf-8", "backslashreplace").decode()


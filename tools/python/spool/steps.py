"""The two steps: samples are taken, and an image is made of them; and what methods there are."""
from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from . import _core
from .arguments import array, choice, flag, image_size, mapping, number, option_text, text, texts, wrong
from .arguments import whole as whole_number
from .cells import density_html, reconstruction_html
from .error import SpoolError
from .images import Image
from .own_methods import Method, method_text
from .recordings import Samples, recording_of

_Step = TypeVar("_Step", bound=Callable)


def _options_apart(step: _Step) -> _Step:
    """An option of a method may have the name of a parameter that is given by its place: Python's own error names neither."""
    names = list(inspect.signature(step).parameters)

    @functools.wraps(step)
    def call(*given, **named):
        for name, value in zip(names, given):
            if name in named:
                method = value if isinstance(value, str) and value.isidentifier() else "METHOD"
                option = " ".join(str(named[name]).split())[:40]
                raise SpoolError("usage", f"{name}: is a parameter of {step.__name__}() that has its value already: an option of that name "
                                          f'goes into the text of the method, "{method}{{{name}={option}}}"')
        return step(*given, **named)
    return call  # type: ignore[return-value]


@_options_apart
def replay(samples: Samples, sampler: str | Method, spp: float, *, seed: int = 0, order: str = "recorded",
           filter: str | Method | None = None, preset: str = "", holdout: int = 0, pieces: int = 1,
           decision_split: bool = False, pool: Mapping | None = None, views: Iterable[str] | None = None,
           threads: int = 0, **options) -> Selection:
    """Spends `spp` samples per pixel of a recording by a sampler -> Selection.

    `samples`: a Dump, a path, a Recording, or an array [y][x][s][3]. `sampler`: a name as the program takes it
    ("multiscale:robust{alpha=0.3}"), or a function made by @spool.sampler; `options` are its own. `order`: in which a
    pixel's samples are taken, "recorded" or "shuffled" by `seed`; the seed is the sampler's, too. `filter`: in the loop of a sampler that has
    one. `pool`: {rule: value} for samples that are no ordinary numbers.
    """
    recording = recording_of(samples)
    before = (method_text("sampler", sampler), number("spp", spp), "" if filter is None else method_text("filter", filter),
              text("preset", preset), settings("sampler", options, pool), *_pool(order, seed, holdout, pieces),
              flag("decision_split", decision_split))
    limit = whole_number("threads", threads)

    def run(wanted, held=(sampler, filter)):  # functions are found while they are held
        return _core.replay(recording.source, *before, ",".join(wanted), limit)

    drawn = {"spp": spp, "seed": seed, "order": order, "holdout": holdout, "pieces": pieces}
    return Selection(recording, run, texts("views", () if views is None else views), drawn, settings("", {}, pool))


class Selection:
    """How many samples of each pixel (piece) a sampler took, and what it knew."""

    def __init__(self, recording, run, views, drawn, rules):
        self.recording, self._run, self.drawn, self.rules = recording, run, drawn, rules  # by what settings of replay, and of its pool
        self.replayed = run(views)
        self._views = self.replayed.views() if views else None

    def __reduce__(self):
        raise SpoolError("usage", "a selection stays in its process: hand over its counts, reconstruct() takes them, or replay there")

    def __repr__(self):
        return f"<spool.Selection of {self.recording.source.name}: {self.log['spent']} samples>"

    def _repr_html_(self):
        return density_html(self)

    @property
    def counts(self) -> np.ndarray:
        """Samples taken of each piece, [y][x] int32."""
        return self.replayed.counts()

    @property
    def image(self) -> np.ndarray:
        """The mean of the samples taken, [y][x][3] float64."""
        return self.replayed.image().view(Image)

    @property
    def log(self) -> dict:
        """budget, initial, spent, uniform_remainder, saturated_pieces, samples_of_level, guards, seconds."""
        return self.replayed.log()

    @property
    def views(self) -> dict[str, np.ndarray]:
        """Intermediate images by name, {"P.2": [y][x]}; without `views=` the sampler runs again for them."""
        if self._views is None:
            self._views = self._run(("all",)).views()
        return self._views


@dataclass(frozen=True, eq=False)  # arrays have no equality that is one value
class Reconstruction:
    """What a filter returns: the image, and what else it has."""

    image: np.ndarray = field(repr=False)  # [y][x][3] float64, radiance
    variance: np.ndarray | None = field(repr=False)  # of the image, [y][x][3]
    level: np.ndarray | None = field(repr=False)  # scale chosen for each piece
    dominant_direction: np.ndarray | None = field(repr=False)  # degrees modulo 180; NaN where round
    notes: list  # what was done other than asked
    guards: Mapping
    seconds: float
    views: Mapping = field(repr=False)

    def _repr_html_(self):
        return reconstruction_html(self)


@_options_apart
def reconstruct(samples: Samples, selection: Selection | np.ndarray | None, filter: str | Method, *, spp: int = 0,
                preset: str = "", seed: int = 0, order: str = "recorded", holdout: int = 0, pieces: int = 1,
                pool: Mapping | None = None, views: Iterable[str] = (), threads: int = 0, whole: bool = False,
                **options) -> np.ndarray | Reconstruction:
    """Makes an image of a selection -> [y][x][3] float64, or with `whole` a Reconstruction.

    `selection`: what replay returned, an array of counts [y][x], or None for the first `spp` samples of every pixel (0:
    all). `filter`: a name as the program takes it, or a function made by @spool.filter; `options` are its own. What
    replay returned keeps its order and pieces, and its pool rules unless `pool` gives others.
    """
    recording, rules = recording_of(samples), settings("", {}, pool)
    if isinstance(selection, Selection):
        _check_drawn(selection, spp=spp, seed=seed, order=order, holdout=holdout, pieces=pieces)
        rules = selection.rules if pool is None else rules
    chosen = (selection.replayed, None) if isinstance(selection, Selection) else (None, _counts(selection))
    arguments = (*chosen, whole_number("spp", spp), text("preset", preset), settings("filter", options, None) + rules,
                 *_pool(order, seed, holdout, pieces), ",".join(texts("views", views)), whole_number("threads", threads))
    everything = flag("whole", whole)
    made = _core.reconstruct(recording.source, method_text("filter", filter), *arguments)
    image = made.image().view(Image)
    if not everything:
        return image
    return Reconstruction(image, made.variance(), made.level(), made.dominant_direction(), made.notes(),
                          made.guards(), made.seconds(), made.views())


def _check_drawn(selection, **given):
    """Those of the selection hold, so another one would be ignored."""
    defaults = {"spp": 0, "seed": 0, "order": "recorded", "holdout": 0, "pieces": 1}
    for name, value in given.items():
        if getattr(value, "ndim", 0) or value not in (defaults[name], selection.drawn[name]):
            raise wrong(name, value, f"not that of the selection, {selection.drawn[name]}: leave it out")


def samplers() -> dict[str, dict]:
    """{name: {"summary", "presets", "options": {name: (default, allowed, meaning)}, "views": {name: meaning}}}"""
    return {entry.pop("name"): entry for entry in _core.samplers()}


def filters() -> dict[str, dict]:
    """As samplers()."""
    return {entry.pop("name"): entry for entry in _core.filters()}


def settings(part, options, pool):
    """["PART.OPTION=VALUE"] as the program's --set takes them."""
    return [f"{part}.{key}={option_text(value)}" for key, value in options.items()] + [
        f"pool.{key}={option_text(value)}" for key, value in mapping("pool", {} if pool is None else pool).items()]


def _pool(order, seed, holdout, pieces):
    return (choice("order", order, ("recorded", "shuffled")) == "shuffled", whole_number("seed", seed, 64), whole_number("holdout", holdout),
            whole_number("pieces", pieces))


def _counts(selection):
    """Whole numbers [y][x], whatever kind of number they are."""
    if selection is None:
        return None
    if isinstance(selection, str):
        raise wrong("selection", selection, "no array of counts: the order is (samples, selection, filter)")
    counts = array("selection", selection)
    if counts.ndim == 0:
        raise wrong("selection", selection, "no array of counts: for the first samples of every pixel write "
                                            f"reconstruct(samples, None, filter, spp={selection})")
    if counts.ndim != 2:
        raise SpoolError("usage", f"selection: has shape {counts.shape}, not (height, width)")
    image_size("selection", counts.shape)
    odd = np.argwhere(~((counts >= -2.0**62) & (counts <= 2.0**62) & (counts == np.floor(counts))))  # NaN, too
    if len(odd):
        y, x = odd[0]
        raise SpoolError("data", f"selection: {counts[y, x]} is no number of samples (pixel {x}, {y})")
    return np.ascontiguousarray(counts, np.int64)

"""The two steps: samples are taken, and an image is made of them."""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from . import _core
from .cells import density_html, reconstruction_html
from .error import SpoolError
from .images import Image
from .own_methods import Method, failure_shown, method_text
from .recordings import Samples, option_text, recording_of


def replay(samples: Samples, sampler: str | Method, spp: float, *, seed: int = 0, order: str = "recorded",
           filter: str | Method | None = None, preset: str = "", holdout: int = 0, pieces: int = 1,
           decision_split: bool = False, pool: Mapping | None = None, views: Iterable[str] | None = None,
           threads: int = 0, **options) -> Selection:
    """Spends `spp` samples per pixel of a recording by a sampler -> Selection.

    `samples`: a Dump, a path, a Recording, or an array [y][x][s][3]. `sampler`: a name as the program takes it
    ("multiscale:robust{alpha=0.3}"), or a function made by @spool.sampler; `options` are its own. `order`: in which a
    pixel's samples are taken, "recorded" or "shuffled" by `seed`; the seed is the sampler's, too. `filter`: in the loop of a sampler that wants
    one. `pool`: {rule: value} for samples that are no ordinary numbers.
    """
    recording = recording_of(samples)

    def run(wanted):
        with failure_shown(sampler, filter):
            return _core.replay(recording.source, method_text(sampler), spp, method_text(filter) if filter else "", preset,
                                settings("sampler", options, pool), _shuffled(order), seed, holdout, pieces,
                                decision_split, ",".join(wanted), threads)

    return Selection(recording, run, tuple(views or ()))


class Selection:
    """How many samples of each pixel (piece) a sampler took, and what it knew."""

    def __init__(self, recording, run, views):
        self.recording, self._run = recording, run
        self.replayed = run(views)
        self._views = self.replayed.views() if views else None

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


@dataclass(frozen=True)
class Reconstruction:
    """What a filter returns: the image, and what else it has."""

    image: np.ndarray  # [y][x][3] float64, radiance
    variance: np.ndarray | None  # of the image, [y][x][3]
    level: np.ndarray | None  # scale chosen for each piece
    dominant_direction: np.ndarray | None  # degrees modulo 180; NaN where round
    notes: list  # what was done other than asked
    guards: Mapping
    seconds: float
    views: Mapping = field(repr=False)

    def _repr_html_(self):
        return reconstruction_html(self)


def reconstruct(samples: Samples, selection: Selection | np.ndarray | None, filter: str | Method, *, spp: int = 0,
                preset: str = "", seed: int = 0, order: str = "recorded", holdout: int = 0, pieces: int = 1,
                pool: Mapping | None = None, views: Iterable[str] = (), threads: int = 0, whole: bool = False,
                **options) -> np.ndarray | Reconstruction:
    """Makes an image of a selection -> [y][x][3] float64, or with `whole` a Reconstruction.

    `selection`: what replay returned, an array of counts [y][x], or None for the first `spp` samples of every pixel (0:
    all). `filter`: a name as the program takes it, or a function made by @spool.filter; `options` are its own.
    """
    recording = recording_of(samples)
    counts = None
    if selection is not None and not isinstance(selection, Selection):
        counts = np.ascontiguousarray(selection, np.int64)
    with failure_shown(filter):
        made = _core.reconstruct(recording.source, method_text(filter),
                                 selection.replayed if isinstance(selection, Selection) else None, counts, spp, preset,
                                 settings("filter", options, pool), _shuffled(order),
                                 seed, holdout, pieces, ",".join(views), threads)
    image = made.image().view(Image)
    if not whole:
        return image
    return Reconstruction(image, made.variance(), made.level(), made.dominant_direction(), made.notes(),
                          made.guards(), made.seconds(), made.views())


def settings(part, options, pool):
    """["PART.OPTION=VALUE"] as the program's --set takes them."""
    return [f"{part}.{key}={option_text(value)}" for key, value in options.items()] + [
        f"pool.{key}={option_text(value)}" for key, value in (pool or {}).items()]


def _shuffled(order):
    if order not in ("recorded", "shuffled"):
        raise SpoolError("usage", f"order {order!r}: write recorded or shuffled")
    return order == "shuffled"

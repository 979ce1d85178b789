"""Samplers and filters of one's own: Python functions that take part beside the library's."""
from __future__ import annotations

import contextlib
import hashlib
import inspect
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from . import _core
from .error import SpoolError
from .recordings import option_text

_OF_THE_STAGE = ("clamp", "energy")  # options that every filter has, handled by the library
_MADE = {}  # by kind and key: how the library finds the function of a name that stands in a plan
_LAST = {}  # what a function raised: the library hands on a line of text only


@dataclass(frozen=True)
class Statistics:
    """What a method is told of the samples taken so far. Arrays are of pieces: pixels, unless `pieces=2`."""

    mean: np.ndarray  # [y][x][3], radiance; where n is 0, the neighbours'
    variance: np.ndarray  # [y][x][3], of that mean; below 4 samples pooled with the neighbours'
    n: np.ndarray  # [y][x], samples taken
    left: np.ndarray  # [y][x], samples that are left to take
    features: dict = field(default_factory=dict)  # {"albedo": [y][x][c]}, where asked for and recorded
    feature_variances: dict = field(default_factory=dict)  # of those means, in the same way
    moments: dict = field(default_factory=dict)  # {0.25: {"mean", "m2", "m3", "m4": [y][x][3]}}, for each lambda asked for
    round: int = 0  # these five are a sampler's alone: 0 .. rounds - 1
    rounds: int = 1
    budget_left: int = 0  # samples
    share: int = 0  # of budget_left, were it spent evenly over the rounds to come
    seed: int = 0

    @property
    def luminance(self):
        """Of the mean, [y][x]."""
        return self.mean @ (0.2126, 0.7152, 0.0722)


class Method:
    """A function as a method; calling it calls the function."""

    def __init__(self, function, kind, init_spp, rounds, features, moments, label):
        self.function, self.kind = function, kind
        self.label = label or function.__name__
        self.init_spp, self.rounds, self.features, self.moments = init_spp, rounds, features, moments
        parameters = list(inspect.signature(function).parameters.values())[1:]
        self.defaults = {p.name: p.default for p in parameters if p.kind is not p.VAR_KEYWORD}
        for name, default in self.defaults.items():
            if default is inspect.Parameter.empty or not isinstance(default, (bool, int, float, str)):
                raise SpoolError("usage", f"{self.label}: option {name} needs a default: a number, a text, True or False")
            if kind == "filter" and name in _OF_THE_STAGE:
                raise SpoolError("usage", f"{self.label}: every filter has an option {name} already: name yours otherwise")
        # Results are kept by what made them: another function of the same name is another method.
        self.key = f"{function.__name__}@{hashlib.sha256(_code_of(function).encode()).hexdigest()[:8]}"
        _MADE[kind, self.key] = self
        self.__doc__ = function.__doc__

    def __call__(self, *arguments, **options):
        return self.function(*arguments, **options)

    def __repr__(self):
        return f"<spool.{self.kind} {self.label}>"

    def with_options(self, texts):
        """Ready to be called, with its options as texts."""
        given = dict(texts)
        own = {"features": self.features, "moments": self.moments, **({"init_spp": self.init_spp, "rounds": self.rounds} if self.kind == "sampler"
                                             else {})}
        chosen = {name: given.pop(name) for name in list(given) if name in own}
        options = dict(self.defaults)
        for name, text in given.items():
            if name not in options:
                known = ", ".join([*own, *options])
                raise SpoolError("usage", f"option {name}: unknown: it has {known}")
            options[name] = _value_of(name, text, options[name])
        first = chosen.get("init_spp", self.init_spp)
        return _Ready(self, options, None if first in (None, "auto") else _value_of("init_spp", first, 1),
                      _value_of("rounds", chosen.get("rounds", self.rounds), 1),
                      _value_of("features", chosen.get("features", self.features), True),
                      _lambdas(chosen.get("moments", self.moments)))


@dataclass(frozen=True)
class _Ready:
    method: Method
    options: dict
    init_spp: int | None
    rounds: int
    features: bool
    moments: list

    def ask(self, told):
        """What the module calls: the arrays of Statistics in, wants [y][x] or an image [y][x][3] out."""
        for layers in ("features", "feature_variances"):
            told[layers] = {name: np.stack(channels, axis=-1) for name, channels in told[layers].items()}
        statistics = Statistics(**told)
        try:
            answer = np.asarray(self.method.function(statistics, **self.options))
            return _wants(answer, statistics) if self.method.kind == "sampler" else _image(answer, statistics)
        except BaseException as reason:
            _LAST["raised"] = reason  # for failure_shown
            raise


def sampler(function: Callable | None = None, *, init_spp: int | None = None, rounds: int = 4, features: bool = False,
            moments: tuple[float, ...] = (), label: str | None = None) -> Method | Callable[[Callable], Method]:
    """Makes a function a sampler.

    It is asked `rounds` times, after every pixel took `init_spp` samples (None: 4 from 8 samples per pixel on, else 2),
    with Statistics, and answers [y][x]: whole numbers are how many more samples it wants; other numbers are weights by
    which its share of the budget is given out. `features`: also the means of albedo, normal and depth, and their
    variances. `moments`: also moments of the samples transformed with these lambda, as (x^lambda - 1) / lambda. Further
    parameters with defaults are options. `label`: its name in tables, else the function's.
    """
    def make(of):
        return Method(of, "sampler", init_spp, rounds, features, moments, label)
    return make(function) if function else make


def filter(function: Callable | None = None, *, features: bool = False, moments: tuple[float, ...] = (),
           label: str | None = None) -> Method | Callable[[Callable], Method]:
    """Makes a function a filter: Statistics in, an image [y][x][3] of finite values out.

    `features`, `label` and further parameters as of a sampler; `clamp` and `energy` are options of every filter.
    """
    def make(of):
        return Method(of, "filter", None, 1, features, moments, label)
    return make(function) if function else make


def method_text(method: str | Method) -> str:
    """A method as the program writes it."""
    return f"python:{method.key}" if isinstance(method, Method) else str(method)


@contextlib.contextmanager
def failure_shown(*methods):
    """What a function of one's own raised stands behind the error that it became."""
    if not any(isinstance(method, Method) for method in methods):
        yield
        return
    _LAST.clear()
    try:
        yield
    except SpoolError as error:
        raise error from _LAST.pop("raised", None)


def _look_up(kind, key, texts):
    if (kind, key) not in _MADE:
        raise SpoolError("usage", f"no {kind} of that name was made here: decorate it with @spool.{kind} first")
    return _MADE[kind, key].with_options(texts)


def _wants(answer, statistics):
    if answer.ndim != 2 or answer.dtype.kind not in "iufb":
        raise TypeError(f"a sampler answers with numbers [y][x], not {answer.dtype} of shape {answer.shape}")
    if answer.shape != statistics.n.shape:
        raise ValueError(f"{answer.shape} wants answered for {statistics.n.shape} pieces")
    return np.ascontiguousarray(answer, np.float64 if answer.dtype.kind == "f" else np.int64)


def _image(answer, statistics):
    if answer.ndim != 3 or answer.shape[2] != 3 or answer.dtype.kind not in "iuf":
        raise TypeError(f"a filter answers with an image [y][x][3], not {answer.dtype} of shape {answer.shape}")
    return np.ascontiguousarray(answer, np.float64)


def _value_of(name, text, like):
    """An option that is a text, as a value of the kind that its default is."""
    if not isinstance(text, str):
        return text
    try:
        if isinstance(like, bool):
            return {"on": True, "off": False, "True": True, "False": False}[text]
        return type(like)(text)
    except (KeyError, ValueError):
        raise SpoolError("usage", f"option {name}: '{text}' is no {type(like).__name__}: its default is "
                                  f"{option_text(like)}") from None


def _lambdas(moments):
    """Of transforms, from numbers or from a text as the program writes it: off, 0.25, 0.25+1."""
    parts = ([] if moments == "off" else moments.split("+")) if isinstance(moments, str) else np.atleast_1d(moments).tolist()
    chosen = [_value_of("moments", part, 1.0) for part in parts]
    if not all(0 < value <= 4 for value in chosen):
        raise SpoolError("usage", f"option moments: {moments}: each lambda is above 0, at most 4")
    return [float(value) for value in chosen]


def _code_of(function):
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):  # typed at a prompt
        code = function.__code__
        return f"{code.co_code.hex()} {code.co_consts} {code.co_names} {function.__defaults__}"


_core.call_methods_through(_look_up)

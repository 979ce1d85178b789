"""Samplers and filters of one's own: Python functions that take part beside the library's."""
from __future__ import annotations

import atexit
import inspect
import os
import weakref
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from . import _core
from .arguments import flag, option_text, text, whole, wrong
from .error import SpoolError
from .function_identity import hash_of

_OF_THE_STAGE = {"filter": ("clamp", "residual", "energy"), "sampler": ()}  # options that every one has, handled by the library
_MADE = weakref.WeakKeyDictionary()  # the names of a method, by which the library finds it while a call holds it


@dataclass(frozen=True, eq=False)  # arrays have no equality that is one value
class Statistics:
    """What a method gets of the samples taken so far. Arrays are of pieces: pixels, unless `pieces=2`."""

    mean: np.ndarray = field(repr=False)  # [y][x][3], radiance; where n is 0, the neighbours'
    variance: np.ndarray = field(repr=False)  # [y][x][3], of that mean; below 4 samples pooled with the neighbours'
    n: np.ndarray = field(repr=False)  # [y][x], samples taken
    left: np.ndarray = field(repr=False)  # [y][x], samples that are left to take
    features: dict = field(default_factory=dict, repr=False)  # {"albedo": [y][x][c]}, where asked for and recorded; depth divided by its largest
    feature_variances: dict = field(default_factory=dict, repr=False)  # of those means, in the same way
    moments: dict = field(default_factory=dict, repr=False)  # {0.25: {"mean", "m2", "m3", "m4": [y][x][3]}}, for each lambda asked for
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
        if not callable(function) or not hasattr(function, "__code__"):
            raise wrong(f"spool.{kind}", function, "no function")
        self.function, self.kind = function, kind
        self.label = function.__name__ if label is None else text("label", label)
        # As the program writes them; what each may be stands in the library's table.
        self.texts = {"features": option_text(flag("features", features))}
        if kind == "sampler":
            self.texts["init_spp"] = "auto" if init_spp is None else str(whole("init_spp", init_spp))
            self.texts["rounds"] = str(whole("rounds", rounds))
        self.moments = _lambdas(moments)
        parameters = list(inspect.signature(function).parameters.values())[1:]
        self.defaults = {p.name: p.default for p in parameters if p.kind is not p.VAR_KEYWORD}
        for name, default in self.defaults.items():
            if default is inspect.Parameter.empty or not isinstance(default, (bool, int, float, str)):
                raise SpoolError("usage", f"{self.label}: option {name} needs a default: a number, a text, True or False")
            if name in (*self.texts, "moments", *_OF_THE_STAGE[kind]):
                raise SpoolError("usage", f"{self.label}: every {kind} has an option {name} already: name yours otherwise")
        _core.check_called_options(self.with_options({}))
        self.__doc__, self.__module__ = function.__doc__, function.__module__

    @property
    def key(self):
        """Results are kept by it: another function of the same name is another method, and so is one that something else
        around it has made another."""
        return f"{self.function.__name__}@{hash_of(self.function, (self.texts, self.moments))}"

    def __call__(self, *arguments, **options):
        return self.function(*arguments, **options)

    def __repr__(self):
        return f"<spool.{self.kind} {self.label}>"

    def __reduce__(self):
        return self.function.__qualname__  # pickled by name, as its function would be

    def with_options(self, texts):
        """Ready to be called, with its options as texts."""
        given = dict(texts)
        own = {name: given.pop(name, value) for name, value in self.texts.items()}
        moments = _lambdas(given.pop("moments")) if "moments" in given else self.moments
        options = dict(self.defaults)
        for name, value in given.items():
            if name not in options:
                known = ", ".join([*own, "moments", *options])
                raise SpoolError("usage", f"option {name}: unknown: it has {known}")
            options[name] = _value_of(name, value, options[name])
        return _Ready(self, options, own, moments)


@dataclass(frozen=True)
class _Ready:
    method: Method
    options: dict
    texts: dict
    moments: list

    def ask(self, told):
        """What the module calls: the arrays of Statistics in, wants [y][x] or an image [y][x][3] out."""
        for layers in ("features", "feature_variances"):
            told[layers] = {name: np.stack(channels, axis=-1) for name, channels in told[layers].items()}
        statistics = Statistics(**told)
        try:
            answer = self.method.function(statistics, **self.options)
            return _wants(answer, statistics) if self.method.kind == "sampler" else _image(answer, statistics)
        except BaseException:  # noqa: TRY203 - Python before 3.12 makes an object of what the module is to keep only here
            raise


def sampler(function: Callable | None = None, *, init_spp: int | None = None, rounds: int = 4, features: bool = False,
            moments: tuple[float, ...] = (), label: str | None = None) -> Method | Callable[[Callable], Method]:
    """Makes a function a sampler.

    It is asked `rounds` times, after every pixel took `init_spp` samples (None: 4 from 8 samples per pixel on, else 2),
    with Statistics, and answers [y][x]: integers are how many more samples it wants; floats are weights by
    which its share of the budget is given out. `features`: also the means of albedo, normal and depth, and their
    variances. `moments`: also moments of the samples transformed with these lambda, as (x^lambda - 1) / lambda. Further
    parameters with defaults are options. `label`: its name in tables, else the function's.
    """
    make = lambda of: Method(of, "sampler", init_spp, rounds, features, moments, label)
    return make if function is None else make(function)


def filter(function: Callable | None = None, *, features: bool = False, moments: tuple[float, ...] = (),
           label: str | None = None) -> Method | Callable[[Callable], Method]:
    """Makes a function a filter: Statistics in, an image [y][x][3] of finite values out.

    `features`, `label` and further parameters as of a sampler; `clamp`, `residual` and `energy` are options of every filter.
    """
    make = lambda of: Method(of, "filter", None, 1, features, moments, label)
    return make if function is None else make(function)


def method_text(kind: str, method: str | Method) -> str:
    """A method as the program writes it."""
    if isinstance(method, Method):
        if method.kind != kind:
            raise SpoolError("usage", f"{kind}: {method!r} is a {method.kind}")
        key = method.key
        _MADE.setdefault(method, set()).add(key)
        return f"python:{key}"
    if callable(method):
        name = getattr(method, "__name__", None) or type(method).__name__
        raise SpoolError("usage", f"{kind}: {name} is a function without its decorator: write @spool.{kind} above it, or "
                                  f"spool.{kind}({name})")
    if not isinstance(method, str):
        raise wrong(kind, method, f"neither the name of a {kind} nor a function made by @spool.{kind}")
    return text(kind, method)


def _look_up(kind, key, texts):
    for held in _MADE.keyrefs():
        method = held()
        if method is not None and method.kind == kind and key in _MADE[method]:
            return method.with_options(texts)
    raise SpoolError("usage", f"no {kind} of that name was made here: decorate it with @spool.{kind} first")


def _wants(answer, statistics):
    if isinstance(answer, np.ma.MaskedArray):
        raise TypeError("a sampler answers with a plain array, not a masked one")
    answer = np.asarray(answer)
    if answer.ndim != 2 or answer.dtype.kind not in "iufb":
        raise TypeError(f"a sampler answers with numbers [y][x], not {answer.dtype} of shape {answer.shape}")
    if answer.shape != statistics.n.shape:
        raise ValueError(f"a sampler answers with shape {statistics.n.shape}, not {answer.shape}")
    if answer.dtype.kind != "f":
        _check(answer <= 2**62, answer, "no number of samples")  # unsigned ones would turn negative
        return np.ascontiguousarray(answer, np.int64)
    weights = np.ascontiguousarray(answer, np.float64)
    _check(np.isfinite(weights) & (weights >= 0), weights, "no weight", ": each is finite and not below 0")
    return weights


def _check(right, values, what, remedy=""):
    odd = np.argwhere(~right)
    if len(odd):
        y, x = odd[0]
        raise ValueError(f"{values[y, x]} is {what} (pixel {x}, {y}){remedy}")


def _image(answer, statistics):
    if isinstance(answer, np.ma.MaskedArray):
        raise TypeError("a filter answers with a plain array, not a masked one")
    answer = np.asarray(answer)
    if answer.ndim != 3 or answer.shape[2] != 3 or answer.dtype.kind != "f":
        raise TypeError(f"a filter answers with an image [y][x][3] of floats, not {answer.dtype} of shape {answer.shape}")
    return np.ascontiguousarray(answer, np.float64)


def _value_of(name, text, like):
    """An option that is a text, as a value of the kind that its default is."""
    try:
        if isinstance(like, bool):
            return {"on": True, "off": False, "True": True, "False": False}[text]
        return type(like)(text)
    except (KeyError, ValueError):
        raise SpoolError("usage", f"option {name}: '{text}' is no {type(like).__name__}: its default is "
                                  f"{option_text(like)}") from None


def _lambdas(moments):
    """Of transforms, from numbers or from a text as the program writes it: off, 0.25, 0.25+1."""
    try:
        if isinstance(moments, str):
            parts = [] if moments == "off" else moments.split("+")
        else:
            parts = np.atleast_1d(moments)
            if parts.ndim > 1:
                raise ValueError
        chosen = [float(part) for part in parts]
    except (TypeError, ValueError, OverflowError):
        raise wrong("option moments", moments, "no list of numbers") from None
    if not all(0 < value <= 4 for value in chosen):
        raise SpoolError("usage", f"option moments: {moments}: each lambda is above 0, at most 4")
    return chosen


_core.call_methods_through(_look_up)
os.register_at_fork(after_in_child=_core.forget_calls)
atexit.register(_core.end_all_work)  # no thread is to be at work when the interpreter goes

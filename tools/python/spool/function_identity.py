"""What decides what a Python function does, as a short hash: results of a function are kept by it."""
from __future__ import annotations

import hashlib
import inspect
import os
import pickle
import types

_HERE = os.urandom(8)  # of this process: an object that has no lasting description is itself only here


def hash_of(function: types.FunctionType | types.MethodType, settings: object = ()) -> str:
    """Eight hex digits of its text, its defaults and the values that it takes from around it, functions of the same file
    with theirs, and of `settings`. Other files' functions count by name; files that it reads are not looked at."""
    digest = hashlib.sha256()
    _add(settings, digest, set())
    _add_function(function, digest, set())
    return digest.hexdigest()[:8]


def _add_function(function, digest, known):
    if isinstance(function, types.MethodType):
        _add(function.__self__, digest, known)
        function = function.__func__
    if function in known:
        return
    known.add(function)
    digest.update(_text_of(function).encode())
    _add(function.__defaults__, digest, known)
    _add(function.__kwdefaults__, digest, known)
    for name, value in _taken(function):
        digest.update(f"\0{name}=".encode())
        if isinstance(value, types.FunctionType) and value.__module__ == function.__module__:
            _add_function(value, digest, known)
        else:
            _add(value, digest, known)


def _taken(function):
    """(name, value) of enclosing functions and of the module, by name."""
    cells = zip(function.__code__.co_freevars, function.__closure__ or ())
    found = {name: function.__globals__[name] for name in _names_in(function.__code__) if name in function.__globals__}
    for name, cell in cells:
        try:
            found[name] = cell.cell_contents
        except ValueError:  # not bound yet
            continue
    return sorted(found.items())


def _names_in(code):
    """Of the code and of the functions that stand in it."""
    inner = (constant for constant in code.co_consts if isinstance(constant, types.CodeType))
    return {*code.co_names, *(name for part in inner for name in _names_in(part))}


def _add(value, digest, known):
    if isinstance(value, types.ModuleType):
        digest.update(value.__name__.encode())
    elif (inner := getattr(value, "function", None)) is not None and isinstance(inner, types.FunctionType):
        _add_function(inner, digest, known)  # one that is a method
    else:
        try:
            pickle.Pickler(_Sink(digest), protocol=4).dump(value)
        except Exception:  # noqa: BLE001 - whatever its __reduce__ raises
            digest.update(_HERE + str(id(value)).encode())


class _Sink:
    def __init__(self, digest):
        self.write = digest.update


def _text_of(function):
    try:
        text = inspect.getsource(function)
    except (OSError, TypeError):  # typed at a prompt
        text = ""
    if text and function.__name__ != "<lambda>":  # several of which may stand in one line
        return text
    return text + _code_text(function.__code__)


def _code_text(code):
    parts = [_code_text(part) if isinstance(part, types.CodeType) else repr(part) for part in code.co_consts]
    return f"{code.co_code.hex()} {parts} {code.co_names}"

"""What decides what a Python function does, as a short hash: results of a function are kept by it."""
from __future__ import annotations

import copyreg
import functools
import hashlib
import inspect
import operator
import os
import pickle
import sys
import sysconfig
import threading
import tokenize
import types

_PROTOCOL = 4
_HERE = os.urandom(8)  # of this process: an object that has no lasting description is itself only here
_PLAIN = frozenset({type(None), bool, int, float, complex, str, bytes, list, tuple, dict})  # as pickle has them
_PYTHON = sysconfig.get_path("stdlib") + os.sep
_LOCKS = (type(threading.Lock()), type(threading.RLock()))  # which are alike
_AROUND = (staticmethod, classmethod, property, functools.cached_property, type(functools.lru_cache(len)))  # functions
_INSIDE = ("__func__", "fget", "fset", "fdel", "func", "__wrapped__")  # where each of these has them


def hash_of(function: types.FunctionType | types.MethodType, settings: object = ()) -> str:
    """Eight hex digits of its text and code, its defaults and the values that it takes from around it, of `settings`, and of
    functions and classes that it reaches in any of these. Those of installed packages count by name; files that it reads
    are not looked at."""
    digest = hashlib.sha256()
    _add(settings, digest, {}, None)
    _add_function(function, digest, {})
    return digest.hexdigest()[:8]


def _add_function(function, digest, known):
    if isinstance(function, types.MethodType):
        _add(function.__self__, digest, known, function.__module__)
        function = function.__func__
    if _is_known(function, digest, known):
        return
    digest.update(_text_of(function).encode())
    _add(function.__defaults__, digest, known, function.__module__)
    _add(function.__kwdefaults__, digest, known, function.__module__)
    for name, value in _taken(function):
        digest.update(f"\0{name}=".encode())
        _add(value, digest, known, function.__module__)


def _add_class(made, digest, known):
    """By what stands in it: its source would not hold what its methods take from around them."""
    if _is_known(made, digest, known):
        return
    digest.update(made.__qualname__.encode())
    _add((type(made), made.__bases__), digest, known, made.__module__)
    for name, value in sorted(vars(made).items()):
        # Python's own notes, some of which have no lasting description.
        if name != "_abc_impl" and (not name.startswith("__") or isinstance(value, (types.FunctionType, *_AROUND))):
            digest.update(f"\0{name}=".encode())
            _add(value, digest, known, made.__module__)


def _is_known(value, digest, known):
    """Described before, or being described: then it counts by its place among those."""
    if id(value) in known:
        digest.update(b"\0%d" % known[id(value)][0])
        return True
    known[id(value)] = len(known), value  # held, so that no other gets its id
    return False


def _taken(function):
    """(name, value) of enclosing functions, of the module, and of modules of one's own that these hold, by name."""
    cells = zip(function.__code__.co_freevars, function.__closure__ or ())
    names = _names_in(function.__code__)
    found = {name: function.__globals__[name] for name in names if name in function.__globals__}
    for name, cell in cells:
        try:
            found[name] = cell.cell_contents
        except ValueError:  # not bound yet
            continue
    modules = list(found.values())
    for module in modules:
        if isinstance(module, types.ModuleType) and not _is_installed(module.__name__):
            inside = {f"{module.__name__}.{name}": vars(module)[name] for name in names if name in vars(module)}
            modules += [value for name, value in inside.items() if name not in found]
            found |= inside
    return sorted(found.items())


def _names_in(code):
    """Of the code and of the functions that stand in it."""
    inner = (constant for constant in code.co_consts if isinstance(constant, types.CodeType))
    return {*code.co_names, *(name for part in inner for name in _names_in(part))}


def _add(value, digest, known, module):
    """`module`: functions and classes of it count by what they do."""
    try:
        if isinstance(value, types.ModuleType):
            digest.update(value.__name__.encode())
        elif isinstance(value, types.FunctionType) and _is_of(value, module):
            _add_function(value, digest, known)
        elif isinstance(value, type) and _is_of(value, module):
            _add_class(value, digest, known)
        else:
            _Description(digest, known, module).dump(value)
    except Exception:  # noqa: BLE001 - whatever its __reduce__ raises
        digest.update(_HERE + str(id(value)).encode())


def _is_of(value, module):
    """Of this module or another that is no package's, or not to be found by its name in its own."""
    try:
        return (value.__module__ == module or not _is_installed(value.__module__)
                or operator.attrgetter(value.__qualname__)(sys.modules[value.__module__]) is not value)
    except (AttributeError, KeyError):
        return True


def _is_installed(module):
    """Of Python, of a package of an installer, or of this one."""
    file = getattr(sys.modules.get(module), "__file__", None)
    return (file is None or module.partition(".")[0] == __package__ or file.startswith(_PYTHON)
            or not {"site-packages", "dist-packages"}.isdisjoint(file.split(os.sep)))


class _Description(pickle.Pickler):
    """A value as pickle has it, but for what pickle names only or writes in an order of this process."""

    def __init__(self, digest, known, module):
        super().__init__(types.SimpleNamespace(write=digest.update), _PROTOCOL)
        self._known, self._module = known, module

    def persistent_id(self, value):
        if type(value) in _PLAIN:
            return None
        if isinstance(value, (set, frozenset)):
            return type(value).__qualname__, sorted(value, key=_order)
        if isinstance(value, _AROUND):
            return type(value).__qualname__, [getattr(value, name, None) for name in _INSIDE]
        if isinstance(value, types.ModuleType) or isinstance(value, (types.FunctionType, type)) and _is_of(value, self._module):
            part = hashlib.sha256()
            _add(value, part, self._known, self._module)
            return part.digest()
        return None

    def reducer_override(self, value):
        """What pickle refuses is itself only here, and what holds it still counts by all else that it holds."""
        if isinstance(value, (type, types.FunctionType)) or type(value) in copyreg.dispatch_table:
            return NotImplemented
        try:
            reduced = value.__reduce_ex__(_PROTOCOL)
            if (not isinstance(reduced, str) or isinstance(value, types.BuiltinFunctionType)
                    or _is_installed(getattr(value, "__module__", None))):
                return reduced
            part = hashlib.sha256(type(value).__qualname__.encode())  # by name: what it holds may change, but for the name
            if not _is_known(value, part, self._known):
                _add({**vars(value), "__module__": None}, part, self._known, self._module)
            return str, (part.digest(),)
        except Exception:  # noqa: BLE001 - whatever it raises
            return str, (type(value).__qualname__, b"" if isinstance(value, _LOCKS) else _HERE + b"%d" % id(value))


def _order(member):
    """By which members of a set are sorted: their hashes are others in each process."""
    return f"{sorted(map(_order, member))}" if isinstance(member, (set, frozenset)) else repr(member)


def _text_of(function):
    try:
        text = inspect.getsource(function)
    except (OSError, TypeError, SyntaxError, tokenize.TokenError):  # typed at a prompt, or another file by now
        text = ""
    return text + _code_text(function.__code__)  # which the file may no longer have


def _code_text(code):
    parts = [_code_text(part) if isinstance(part, types.CodeType) else _order(part) for part in code.co_consts]
    return f"{code.co_code.hex()} {parts} {code.co_names}"

"""A plan as a dict, written as the TOML that `spool evaluate` reads (lib/experiment/plan.h)."""
import json
import os
import re

from .arguments import mapping, text, whole, wrong
from .error import SpoolError
from .own_methods import Method, method_text

_SINGULAR = ("recording", "sampler", "filter")  # in TOML each is a table of its own


def plan_text(plan, path_of):
    """The TOML of a dict. `path_of` gives the path of what stands under "recordings"."""
    top, tables = [], []
    for key, value in mapping("plan", plan).items():
        if key == "recordings":
            top.append(f"recordings = {_value(key, [path_of(item) for item in _as_list(value)])}")
        elif key in ("samplers", "filters"):
            named = [method for method in _as_list(value) if isinstance(method, str)]
            top += [f"{key} = {_value(key, named)}"] if named else []
            tables += [_table(f"[[{key[:-1]}]]", _method(key[:-1], method)) for method in _as_list(value)
                       if not isinstance(method, str)]
        elif key in _SINGULAR and not isinstance(value, (dict, list)):
            raise SpoolError("usage", f"plan: unknown key '{key}', did you mean '{key}s'?")
        elif key in ("spp", "threads"):
            top.append(f"{key} = {_value(key, _as_list(value))}")
        elif isinstance(value, dict):
            tables.append(_table(f"[{_key(key)}]", value))
        elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
            tables += [_table(f"[[{_key(key)}]]", item) for item in value]
        else:
            top.append(f"{_key(key)} = {_value(key, value)}")
    return "\n".join(top + tables) + "\n"


def _method(kind, method):
    """A function, or {"name": a name or a function, option: value or list of values, "label": text}."""
    entry = mapping(f"plan: {kind}", method) if isinstance(method, dict) else {"name": method}
    named = entry.get("name")
    if isinstance(named, Method):
        entry.setdefault("label", named.label)
    if named is not None or not isinstance(method, dict):  # a dict without a name is refused by its reader
        entry["name"] = method_text(kind, named)
    return entry


def _table(heading, entries):
    return "\n".join(["", heading, *(f"{_key(key)} = {_value(f'{heading} {key}', value)}"
                                     for key, value in mapping(f"plan: {heading}", entries).items())])


def _key(key):
    return key if re.fullmatch("[A-Za-z0-9_-]+", key) else _quoted(key)


def _value(key, value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if _is_list(value):
        return "[" + ", ".join(_value(key, item) for item in value) + "]"
    if isinstance(value, (str, os.PathLike)):
        return _quoted(text(f"plan: {key}", os.fspath(value)))
    if isinstance(value, int):
        return repr(whole(f"plan: {key}", value, 64))
    if isinstance(value, float):
        return repr(float(value))  # which a number of numpy's spells otherwise
    if hasattr(value, "item") and getattr(value, "ndim", None) == 0:  # a number of numpy's
        return _value(key, value.item())
    raise wrong(f"plan: {key}", value, "no number, text, list or table (recordings stand under 'recordings', functions under "
                                       "'samplers' and 'filters')")


def _quoted(line):
    # TOML has DEL among what is escaped, JSON has not.
    return json.dumps(line, ensure_ascii=False).replace("\x7f", "\\u007f")


def _as_list(value):
    return list(value) if _is_list(value) else [value]


def _is_list(value):
    return isinstance(value, (list, tuple, range)) or getattr(value, "ndim", 0) == 1  # of numpy's

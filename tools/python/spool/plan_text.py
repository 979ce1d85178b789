"""A plan as a dict, written as the TOML that `spool evaluate` reads (lib/experiment/plan.h)."""
import json
import os

from .error import SpoolError
from .own_methods import Method


def plan_text(plan, path_of):
    """The TOML of a dict. `path_of` gives the path of what stands under "recordings"."""
    top, tables = [], []
    for key, value in plan.items():
        if key == "recordings":
            top.append(f"recordings = {_value([path_of(item) for item in _as_list(value)])}")
        elif key in ("samplers", "filters"):
            named = [method for method in _as_list(value) if isinstance(method, str)]
            top += [f"{key} = {_value(named)}"] if named else []
            tables += [_table(f"[[{key[:-1]}]]", _method(method)) for method in _as_list(value) if method not in named]
        elif key in ("spp", "threads"):
            top.append(f"{key} = {_value(_as_list(value))}")
        elif isinstance(value, dict):
            tables.append(_table(f"[{key}]", value))
        elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
            tables += [_table(f"[[{key}]]", item) for item in value]
        else:
            top.append(f"{key} = {_value(value)}")
    return "\n".join(top + tables) + "\n"


def _method(method):
    """A name, a function, or {"name": either, option: value or list of values, "label": text}."""
    entry = dict(method) if isinstance(method, dict) else {"name": method}
    if isinstance(entry.get("name"), Method):
        entry.setdefault("label", entry["name"].label)
        entry["name"] = f"python:{entry['name'].key}"
    return entry


def _table(heading, entries):
    return "\n".join(["", heading, *(f"{key} = {_value(value)}" for key, value in entries.items())])


def _value(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if isinstance(value, (int, float)):
        return repr(value)
    if hasattr(value, "item"):  # a number of numpy's
        return _value(value.item())
    raise SpoolError("usage", f"plan: {value!r} is no number, text, list or table")


def _as_list(value):
    return list(value) if isinstance(value, (list, tuple)) else [value]

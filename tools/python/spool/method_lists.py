"""What methods there are."""
from __future__ import annotations

from . import _core


def samplers() -> dict[str, dict]:
    """{name: {"summary", "presets", "options": {name: (default, allowed, meaning)}, "views": {name: meaning}}}"""
    return _named(_core.samplers())


def filters() -> dict[str, dict]:
    """As samplers()."""
    return _named(_core.filters())


def _named(entries):
    return {entry.pop("name"): entry for entry in entries}

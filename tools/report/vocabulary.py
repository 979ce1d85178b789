"""What the columns mean, as `spool` says it, and what was recorded of a run.

The program hands its own list over (`--vocabulary`), so that meanings are written down once. Without
it names stand for themselves.
"""

import json

from tools.report.failure import IO, Failure, open_regular


class Vocabulary:
    def __init__(self, data=None):
        data = data if isinstance(data, dict) else {}
        self.version = str(data.get("version", ""))
        self._metrics = _by_name(data.get("metrics"))
        self._columns = _by_name(data.get("columns"))
        self._guards = _by_name(data.get("guards"))
        # Methods of the program itself; other names may be commands.
        self.samplers = frozenset(data.get("samplers") or [])
        self.telling_filters = frozenset(data.get("footprints") or [])

    def meaning(self, column):
        entry = self._metrics.get(column) or self._columns.get(column) or {}
        return str(entry.get("meaning", ""))

    def better(self, metric):
        """lower, higher or near 1."""
        return str(self._metrics.get(metric, {}).get("better", "lower"))

    def guard_meaning(self, guard):
        return str(self._guards.get(guard, {}).get("protects", ""))


def _by_name(entries):
    return {entry["name"]: entry for entry in entries or []
            if isinstance(entry, dict) and isinstance(entry.get("name"), str)}


def read_vocabulary(path):
    return Vocabulary(read_json(path)) if path else Vocabulary()


def read_manifest(folder):
    """manifest.json of the evaluation; empty where none was written."""
    path = folder / "manifest.json"
    data = read_json(path) if path.exists() else {}
    if not isinstance(data, dict):
        return {}
    if not isinstance(data.get("dumps", []), list):
        raise Failure(f"{path}: `dumps` is no list: delete it or run spool evaluate again")
    return data


def read_json(path):
    try:
        with open_regular(path) as file:
            return json.load(file)
    except OSError as error:
        raise Failure(f"{path}: {error.strerror}", IO) from error
    except (ValueError, RecursionError) as error:
        what = "nested too deep" if isinstance(error, RecursionError) else f"not JSON ({error})"
        raise Failure(f"{path}: {what}: delete it or run spool evaluate again") from error

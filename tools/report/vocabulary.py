"""What the columns mean and which way is better, as `spool` says it, and what was recorded of a run.

The program hands its own list over (`--vocabulary`), so that meanings are written down once. Without
it names stand for themselves.
"""

import json

from failure import Failure


class Vocabulary:
    def __init__(self, data=None):
        data = data if isinstance(data, dict) else {}
        self.version = str(data.get("version", ""))
        self._metrics = _by_name(data.get("metrics"))
        self._columns = _by_name(data.get("columns"))
        self._guards = _by_name(data.get("guards"))

    def meaning(self, column):
        entry = self._metrics.get(column) or self._columns.get(column) or {}
        return str(entry.get("meaning", ""))

    def guard_meaning(self, guard):
        return str(self._guards.get(guard, {}).get("protects", ""))

    def better(self, metric):
        """"lower", "higher" or "one" """
        known = self._metrics.get(metric, {}).get("better")
        if known in ("lower", "higher", "one"):
            return known
        if metric.startswith("energy_ratio"):
            return "one"
        return "higher" if metric.startswith(("psnr", "ssim", "ms_ssim")) else "lower"


def _by_name(entries):
    return {entry["name"]: entry for entry in entries or []
            if isinstance(entry, dict) and isinstance(entry.get("name"), str)}


def read_vocabulary(path):
    return Vocabulary(_json(path, required=True)) if path else Vocabulary()


def read_manifest(folder):
    """manifest.json of the evaluation; empty where none was written."""
    data = _json(folder / "manifest.json", required=False)
    return data if isinstance(data, dict) else {}


def _json(path, required):
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        if not required:
            return {}
        raise Failure(f"{path}: {error.strerror}", 3) from error
    except OSError as error:
        raise Failure(f"{path}: {error.strerror}", 3) from error
    except ValueError as error:
        raise Failure(f"{path}: not JSON ({error}): delete it or run spool evaluate again") from error

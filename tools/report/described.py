"""Which methods are no originals: their names carry [R] wherever the page names them."""

import re
from html import escape

MARK = " [R]"


class Described:
    """Methods that the manifest calls re-implementations by description."""

    def __init__(self, manifest):
        plan = manifest.get("plan")
        plan = plan if isinstance(plan, dict) else {}
        described = {kind: [m for m in plan.get(kind) or [] if isinstance(m, dict) and m.get("by_description")]
                     for kind in ("samplers", "filters")}
        self._names = {kind: {str(m.get("name")) for m in methods} for kind, methods in described.items()}
        self._labels = {kind: {str(m.get("label")) for m in methods} for kind, methods in described.items()}

    def mark(self, combinations, statistics):
        """Their names, once nothing looks for files of combinations any more."""
        for c in combinations:
            c.sampler, c.filter = self._marked(c.sampler, c.filter)
        for entry in statistics.methods():
            entry["sampler"], entry["filter"] = self._marked(entry["sampler"], entry["filter"])
        sampler, _, filter_ = statistics.baseline.partition(" + ")
        statistics.baseline = " + ".join(self._marked(sampler, filter_))

    def note(self):
        """What the mark means, beside every table that names such methods."""
        names = sorted(self._names["samplers"] | self._names["filters"])
        if not names:
            return ""
        return f"<p>[R] {escape(', '.join(names))}: re-implementation by description, not from the primary text.</p>"

    def _marked(self, *labels):
        """Of a sampler and a filter."""
        return [label + MARK if re.split(r"[:{ ]", label, maxsplit=1)[0] in self._names[kind] or label in self._labels[kind] else label
                for label, kind in zip(labels, ("samplers", "filters"))]

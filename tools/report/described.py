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

    def sampler(self, label):
        return self._marked(label, "samplers")

    def filter(self, label):
        return self._marked(label, "filters")

    def mark(self, combinations):
        """The names of combinations, once nothing looks for their files any more."""
        for c in combinations:
            c.sampler, c.filter = self.sampler(c.sampler), self.filter(c.filter)

    def mark_statistics(self, statistics):
        for entry in statistics.methods():
            entry["sampler"], entry["filter"] = self.sampler(entry["sampler"]), self.filter(entry["filter"])
        sampler, _, filter_ = statistics.baseline.partition(" + ")
        statistics.baseline = f"{self.sampler(sampler)} + {self.filter(filter_)}"

    def note(self):
        """What the mark means, beside every table that names such methods."""
        names = sorted(self._names["samplers"] | self._names["filters"])
        if not names:
            return ""
        return f"<p>[R] {escape(', '.join(names))}: re-implementation by description, not from the primary text.</p>"

    def _marked(self, label, kind):
        named = re.split(r"[:{ ]", label, maxsplit=1)[0] in self._names[kind]
        return label + MARK if named or label in self._labels[kind] else label

"""The methods that a plan names, sweeps written out."""
import itertools

from results import canonical


def methods_of(plan, kind):
    """(label as in the results, name with preset, [(option, value)]); `kind` is sampler or filter."""
    for name in plan.get(kind + "s", []):
        yield name, name, []
    for entry in plan.get(kind, []):
        entry = dict(entry)
        name = entry.pop("name")
        preset = entry.pop("preset", None)
        full = f"{name}:{preset}" if preset else name
        lists = [v if isinstance(v, list) else [v] for v in entry.values()]
        for values in itertools.product(*lists):
            options = list(zip(entry, values))
            text = ",".join(f"{o}={v}" for o, v in options)
            yield canonical(full + (f"{{{text}}}" if text else "")), full, options

"""The methods of a plan of tools/plans, as its results name them."""
import itertools


def methods_of(plan, kind):
    """[(label as in the results, name with preset, {option: value})], sweeps written out; kind is sampler or filter."""
    found = [(name, name, {}) for name in plan.get(kind + "s", [])]
    for entry in plan.get(kind, []):
        settings = {k: v if isinstance(v, list) else [v] for k, v in sorted(entry.items()) if k not in ("name", "preset")}
        name = entry["name"] + (f":{entry['preset']}" if "preset" in entry else "")
        for values in itertools.product(*settings.values()):
            options = dict(zip(settings, values))
            text = ",".join(f"{o}={v}" for o, v in options.items())
            found.append((name + (f"{{{text}}}" if text else ""), name, options))
    return found

"""The section of docs/speed.md that says what every method costs: tables of what run.py measured."""
import math
import os

from tools.study.tables import markdown

LARGE = 4096  # pixels a side of pictures with fewer samples, which growth leaves out
JUDGED, BUDGET, BYTES, TWO_THREADS, LONG = 512, 8, 300, 1.8, 0.5
# Targets in CPU seconds a megapixel of a machine on which the command of Open Image Denoise takes OIDN of them; of methods that are not named, OTHERS.
YARDSTICK, OIDN = "command/oidn", 1.7
SECONDS = {"sampler/nl_means": 10, "filter/nl_means": 2.5, "filter/directional": 0.5}
OTHERS = 10.0


def told(value, digits, holds=True):
    return f"{value:.{digits}f}" if holds else f"**{value:.{digits}f}**"


def of(kept, size, threads, method):
    found = kept.get((size, threads), {}).get(method)
    return found if found and "cpu" in found else None


def speedup(one, two):
    """Of two threads: one thread has its CPU time where nothing else runs."""
    return one["cpu"] / two["wall"]


def megapixel(found):
    return found["cpu"] / JUDGED ** 2 * 1e6


def oidn(kept):
    """CPU seconds a megapixel of that command on this machine; where it was not measured, as the targets have it."""
    return kept.get((JUDGED, 1), {}).get(YARDSTICK, {}).get("command", OIDN * JUDGED ** 2 / 1e6) / JUDGED ** 2 * 1e6


def name_of(method, found):
    return f"`{method.split('/')[1]}`" + ("*" if found["features"] else "")


def judged(kind, kept, names):
    """Seconds, memory and threads at the size that the targets name."""
    rows = [[kind, "CPU-s/MP", "target", "bytes/pixel", "2 threads, times faster", "growth"]]
    exponent = {name: row[-1] for row in growth_rows(kept)[1:] for name in [f"{row[0]}/{row[1]}"]}
    for method in names:
        one, two = of(kept, JUDGED, 1, method), of(kept, JUDGED, 2, method)
        if one is None:
            continue
        limit = SECONDS.get(method, OTHERS) * oidn(kept) / OIDN
        faster = speedup(one, two) if two else None
        rows.append([name_of(method, one), told(megapixel(one), 3, megapixel(one) <= limit), f"{limit:.3g}",
                     told(one["heap"], 0, one["heap"] <= BYTES),
                     "" if faster is None else told(faster, 2, faster >= TWO_THREADS or megapixel(one) <= LONG), exponent[method]])
    return markdown(rows[0], rows[1:])


def growth_rows(kept):
    """CPU microseconds of a pixel at each size, how many times faster two threads are there, and the power of the number of pixels
    that the time grows with; first the heading."""
    sizes = sorted({size for size, _ in kept})
    rows = [["kind", "method", *map(str, sizes), *(f"2 threads at {size}" for size in sizes), "growth"]]
    for name in dict.fromkeys(method for methods in kept.values() for method in methods):
        pixel = {size: 1e6 * at["cpu"] / size ** 2 for size in sizes if (at := of(kept, size, 1, name))}
        if pixel:
            least, most = min(pixel), max(s for s in pixel if s < LARGE or s == min(pixel))
            growth = f"{1 + math.log(pixel[most] / pixel[least]) / math.log((most / least) ** 2):.2f}" if most > least else ""
            faster = [(of(kept, size, 1, name), of(kept, size, 2, name)) for size in sizes]
            rows.append([*name.split("/"), *(f"{pixel[size]:.3f}" if size in pixel else "" for size in sizes),
                         *(f"{speedup(*pair):.2f}" if all(pair) else "" for pair in faster), growth])
    return rows


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as stream:
        model = next((line.split(":")[1].strip() for line in stream if line.startswith("model name")), "unknown")
    return f"{model}, {os.cpu_count()} cores"


def page(kept):
    names = list(dict.fromkeys(method for methods in kept.values() for method in methods))
    sizes = sorted({size for size, _ in kept})
    text = [f"## Every method in the library\n\n`tools/dev.sh bench methods`: CPU seconds a megapixel of one thread at {JUDGED}x{JUDGED} pixels, {BUDGET} samples a pixel of 64 (of 16 at {LARGE}), scene S; filters",
            f"get that of `multiscale`; in the loop of a sampler runs `directional`, below `twin_guides`. The call alone, the recording loaded. {machine()}. A bold figure misses its target: the seconds",
            f"named (if the command of Open Image Denoise takes {OIDN}; here {oidn(kept):.2f}), {BYTES} bytes a pixel beside the mapped recording (for a filter with all that it reads), {TWO_THREADS} times faster on two threads (methods",
            f"above {LONG:g} s). A star: the method needs features, and ran on mirrored copies of `dumps/tiny/chess.spool`. Growth: the power of the",
            f"number of pixels that the time grows with to 2048x2048 ([sizes.csv](results/speed/sizes.csv): {', '.join(map(str, sizes))} pixels a side, one thread and two).", ""]
    kinds = {kind: [name for name in names if name.startswith(kind + "/")] for kind in ("sampler", "filter")}
    for kind, methods in kinds.items():
        text += [judged(kind, kept, methods), ""]
    return "\n".join(text)

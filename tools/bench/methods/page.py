"""The section of docs/speed.md that says what every method costs: tables of what run.py measured."""
import os

JUDGED, BUDGET, BYTES, TWO_THREADS, LONG = 1024, 8, 300, 1.8, 0.5
# Targets in CPU seconds at JUDGED; of methods that are not named, OTHERS.
SECONDS = {"sampler/nl_means": 10, "filter/nl_means": 2.5, "filter/directional": 0.5}
OTHERS = 10.0
PAIRS = {("sampler/multiscale", "filter/directional"): 2.5, ("sampler/greedy_error", "filter/greedy_selection"): 4,
         ("sampler/filtered_halves", "filter/directional"): 6}


def told(value, digits, holds=True):
    return f"{value:.{digits}f}" if holds else f"**{value:.{digits}f}**"


def lines(rows):
    head, *body = rows
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *body])


def of(kept, size, threads, where, method):
    found = kept.get((size, threads, where), {}).get(method)
    return found if found and "cpu" in found else None


def name_of(method, found):
    return f"`{method.split('/')[1]}`" + ("*" if found["features"] else "")


def judged(kind, kept, names):
    """Seconds, memory and threads at the size that the targets name."""
    rows = [[kind, "library, CPU-s", "target", "whole command, CPU-s", "bytes/pixel", "2 threads, times faster"]]
    for method in names:
        one, two, whole = (of(kept, JUDGED, threads, where, method) for threads, where in ((1, "library"), (2, "library"), (1, "command")))
        if one is None:
            continue
        limit = SECONDS.get(method, OTHERS)
        faster = one["wall"] / two["wall"] if two else None
        rows.append([name_of(method, one), told(one["cpu"], 3, one["cpu"] <= limit), f"{limit:g}", told(whole["cpu"], 2) if whole else "",
                     told(one["heap"], 0, one["heap"] <= BYTES),
                     "" if faster is None else told(faster, 2, faster >= TWO_THREADS or one["cpu"] <= LONG)])
    return lines(rows)


def growth_rows(kept):
    """CPU microseconds of a pixel at each size, library and whole command; first the heading."""
    sizes = sorted({size for size, _, _ in kept})
    rows = [["kind", "method", *map(str, sizes), f"largest / {sizes[0]}", *(f"command, {size}" for size in sizes)]]
    for name in dict.fromkeys(method for methods in kept.values() for method in methods):
        pixel = {where: {size: 1e6 * at["cpu"] / size ** 2 for size in sizes if (at := of(kept, size, 1, where, name))} for where in ("library", "command")}
        if pixel["library"]:
            growth = pixel["library"][max(pixel["library"])] / pixel["library"][min(pixel["library"])]
            rows.append([*name.split("/"), *(f"{pixel['library'][size]:.3f}" if size in pixel["library"] else "" for size in sizes), f"{growth:.2f}",
                         *(f"{pixel['command'][size]:.2f}" if size in pixel["command"] else "" for size in sizes)])
    return rows


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as stream:
        model = next((line.split(":")[1].strip() for line in stream if line.startswith("model name")), "unknown")
    return f"{model}, {os.cpu_count()} cores"


def page(kept):
    names = list(dict.fromkeys(method for methods in kept.values() for method in methods))
    text = [f"## Every method\n\n`tools/dev.sh bench methods`: CPU seconds of one thread at {JUDGED}x{JUDGED} pixels, {BUDGET} samples a pixel of 64, scene S; filters",
            "get the selection of `multiscale`. The library's time is the call alone, the recording loaded; the whole command is `spool replay` or",
            f"`spool reconstruct --selection`, from start to the written image, checksums verified. {machine()}. A bold figure misses its target: the seconds",
            f"named, {BYTES} bytes a pixel beside the mapped recording (for a filter with all that it reads), {TWO_THREADS} times faster on two threads (methods",
            f"above {LONG:g} s). A star: the method needs features, and ran on mirrored copies of `dumps/tiny/chess.spool`, which has them.", ""]
    kinds = {kind: [name for name in names if name.startswith(kind + "/")] for kind in ("sampler", "filter")}
    for kind, methods in kinds.items():
        text += [judged(kind, kept, methods), ""]
    text += ["CPU microseconds of a pixel at 512 to 4096 pixels a side: [sizes.csv](results/speed/sizes.csv).", ""]
    for (sampler, filter), limit in PAIRS.items():
        both = [[of(kept, JUDGED, 1, where, method) for method in (sampler, filter)] for where in ("library", "command")]
        if all(part for parts in both for part in parts):
            library, command = (sum(part["cpu"] for part in parts) for parts in both)
            text.append(f"- `{sampler.split('/')[1]}` and `{filter.split('/')[1]}`: {library:.2f} CPU-s in the library, {command:.2f} as commands, target {limit:g}.")
    return "\n".join(text)

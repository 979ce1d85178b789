"""What is kept in the tree of one plan's results on one recording: docs/results/experiments_full/measured/PLAN/RECORDING.jsonl.

Recordings of full size are on no machine together, and their results are made over days: each is kept by itself, small, with
what it was made by, and the page is written from all of them. The first line says of which plan, recording and program;
then a line for each method and budget with the intervals of statistics.json and a few columns of each replicate; then one for each
budget and metric with the verdicts of all pairs. Numbers have six digits, except the MSE of replicates, which is compared bit by bit.
"""
import itertools
import json

from whole_file import write_whole

FORMAT = 1
QUANTITIES = ("mse", "relmse", "relmse_trimmed", "energy_ratio", "flip_ldr", "ssim", "relmse_equal_energy", "mse_bias2", "mse_variance")
COLUMNS = ("replicate", "mse", "relmse", "energy_ratio", "saturated_share", "cpu_sampling", "cpu_filtering", "seconds_sampling",
           "seconds_filtering", "seconds_per_sample", "mse_fresh", "relmse_fresh", "energy_fresh", "mse_bias2", "mse_variance")
OF_THREADS = ("seconds_sampling", "seconds_filtering", "seconds_per_sample")  # kept where several numbers of threads were run
METRICS = ("mse", "relmse")  # those of which all pairs are judged
LETTERS = {"better": "b", "worse": "w", "undecided": "u", "identical": "i", "not compared": "."}
WORDS = {letter: word for word, letter in LETTERS.items()}
# Of more methods than the first only the ratios to uniform + box and between those with one sampler or one filter are kept; of more than
# the second only the former. Those left out are made from the replicates (Results.ratio_or_made).
ALL_RATIOS, SOME_RATIOS = 50, 80
BASE = ("uniform", "box")


def short(value, digits=6):
    return float(f"{value:.{digits}g}") if isinstance(value, float) else value


def _methods(rows):
    return list(dict.fromkeys((row["sampler"], row["filter"]) for row in rows))


def _cells(rows, statistics, methods, columns):
    figures = {(e["sampler"], e["filter"], e["spp"], e["threads"]): e.get("quantities", {}) for e in statistics["results"]}
    cells = {}
    for row in rows:
        cells.setdefault((row["sampler"], row["filter"], row["spp"], row["threads"]), []).append(row)
    for key, of_cell in cells.items():
        line = {"method": methods.index(key[:2]), "spp": key[2], "threads": key[3]}
        failed = [row["error"] for row in of_cell if row["error"]]
        if failed:
            yield {**line, "error": failed[0]}
            continue
        found = figures.get(key, {})
        line["figures"] = {q: [short(v) for v in found[q]] for q in QUANTITIES if q in found}
        line["rows"] = [[row[c] if c in ("replicate", "mse") else short(row[c]) for c in columns]
                        for row in sorted(of_cell, key=lambda row: row["replicate"])]
        yield line


def _pairs(condition):
    """{(place, later place): (verdict of the first, ratio)}"""
    found = {}
    for a, b, *ratio, _, verdict in condition.get("pairs", []):
        known = isinstance(ratio[0], float) and ratio[0] > 0
        if a > b:
            a, b, verdict = b, a, {"better": "worse", "worse": "better"}.get(verdict, verdict)
            ratio = [1 / ratio[i] if isinstance(ratio[i], float) and ratio[i] > 0 else None for i in (0, 2, 1)]
        found[a, b] = verdict, [short(v, 4) for v in ratio] if known else None
    return found


def keeps_ratio(count, a, b):
    """Of so many methods, that of these two."""
    alike = a[0] == b[0] or a[1] == b[1]
    return count <= ALL_RATIOS or BASE in (a, b) or (count <= SOME_RATIOS and alike)


def _conditions(statistics, methods):
    for condition in statistics["conditions"]:
        if condition["metric"] not in METRICS:
            continue
        names = [(e["sampler"], e["filter"]) for e in condition["ranking"]]
        pairs, letters, ratios = _pairs(condition), [], {}
        for a, b in itertools.combinations(range(len(names)), 2):
            verdict, ratio = pairs.get((a, b), ("not compared", None))
            letters.append(LETTERS[verdict])
            if ratio and keeps_ratio(len(names), names[a], names[b]):
                ratios[f"{a} {b}"] = ratio
        yield {"metric": condition["metric"], "spp": condition["spp"], "threads": condition["threads"],
               "ranking": [methods.index(name) for name in names],
               "against_best": "".join(LETTERS[e["against_best"]] if "against_best" in e else "+" if e["compared"] else "."
                                       for e in condition["ranking"]),
               "verdicts": "".join(letters), "ratios": ratios}


def condensed(folder, head):
    """Text of the file. head: what to say in its first line besides the methods; folder: of spool evaluate, one recording."""
    rows = [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]
    statistics = json.loads((folder / "statistics.json").read_text())
    methods = _methods(rows)
    several = len({row["threads"] for row in rows}) > 1
    columns = [c for c in COLUMNS if any(row.get(c) is not None for row in rows) and (several or c not in OF_THREADS)]
    lines = [{"measured": FORMAT, **head, "methods": methods, "columns": columns},
             *_cells(rows, statistics, methods, columns), *_conditions(statistics, methods)]
    return "".join(json.dumps(line, separators=(",", ":"), ensure_ascii=False) + "\n" for line in lines)


def keep(folder, head, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, condensed(folder, head))


def keep_as(path, plan, target):
    """What one plan measured as that of another, which asks the same."""
    head, rest = path.read_text(encoding="utf-8").split("\n", 1)
    target.parent.mkdir(parents=True, exist_ok=True)
    write_whole(target, json.dumps({**json.loads(head), "plan": plan}, separators=(",", ":"), ensure_ascii=False) + "\n" + rest)


def read_head(path):
    """The first line, or None where the file is not there or of another format."""
    if not path.exists():
        return None
    with path.open(encoding="utf-8") as file:
        head = json.loads(file.readline())
    return head if head.get("measured") == FORMAT else None


def hardware_threads(source):
    """Of the machine that measured a file, or a folder of spool evaluate; 0 where it was not kept."""
    if source.is_dir():
        return json.loads((source / "manifest.json").read_text())["machine"]["threads"]
    return read_head(source).get("hardware_threads", 0)


def load(path):
    """(rows, statistics) as `spool evaluate` wrote them, as far as they were kept; of other metrics nothing."""
    head, *lines = map(json.loads, path.read_text(encoding="utf-8").splitlines())
    name = [{"sampler": s, "filter": f} for s, f in head["methods"]]
    rows, results, conditions = [], [], []
    for line in lines:
        place = {"dump": head["recording"], "spp": line["spp"], "threads": line["threads"]}
        if "metric" in line:
            best = [{"against_best": WORDS[c]} if c in WORDS else {} for c in line["against_best"]]
            ranking = [{**name[m], "compared": c != ".", **b} for m, c, b in zip(line["ranking"], line["against_best"], best)]
            pairs = []
            for (a, b), letter in zip(itertools.combinations(range(len(ranking)), 2), line["verdicts"]):
                ratio = line["ratios"].get(f"{a} {b}", [None] * 3)
                pairs.append([a, b, *ratio, None, WORDS[letter]])
            conditions.append({**place, "metric": line["metric"], "ranking": ranking, "pairs": pairs})
        elif "error" in line:
            rows.append({**place, **name[line["method"]], "error": line["error"]})
        else:
            rows += [{**place, **name[line["method"]], "error": "", **dict(zip(head["columns"], row))} for row in line["rows"]]
            results.append({**place, **name[line["method"]], "quantities": line["figures"]})
    return rows, {"version": 1, "results": results, "conditions": conditions, "overall": []}

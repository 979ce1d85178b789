"""What is kept of results: docs/results/experiments[_full]/PLAN.tar.xz, folders of `spool evaluate` made small.

    plan.toml, claims.json   as the run had them
    made.json                by which program, when, on which machine; of full size for each recording
    statistics.json          what the program found, without the pairs of methods that no claim names
    curves.json              of 64 x 64 pixels: relMSE in the time of the baseline
    cells/, kept.jsonl       of full size, whose recordings are not in the tree: what is needed to judge them anew

Every verdict, interval and ratio is the program's; nothing is computed here.
"""
import io
import json
import lzma
import subprocess
import sys
import tarfile
import zlib
from pathlib import Path

from tools.report.number_text import in_digits
from tools.report.whole_file import write_whole

QUANTITIES = ("mse", "relmse", "relmse_trimmed", "relmse_equal_energy", "energy_ratio", "flip_ldr", "ssim", "seconds_sampling",
              "seconds_filtering", "cpu_sampling", "cpu_filtering", "saturated_share", "block_jump", "edge_share", "region_area", "mse_half_pixels", "relmse_half_pixels")
FIELDS = (*QUANTITIES, "mse_fresh", "relmse_fresh", "energy_fresh", "samples_spent", "recorded_spp", "recorded_kurtosis", "width",
          "height", "timing", "reference", "error", "mse_worst_share", "relmse_worst_share", "mse_reference_noise", "relmse_reference_noise")
DIGITS = 6
HALVES = ("mse", "relmse", "mse_fresh", "relmse_fresh")


class Failed(Exception):
    """One line for who runs a script of this folder."""


def run(main):
    try:
        main()
    except Failed as reason:
        sys.exit(f"study: {reason}")
    except subprocess.CalledProcessError as reason:
        sys.exit(f"study: spool {reason.cmd[1]} stopped with exit code {reason.returncode}")


def evaluate(program, plan, folder, *more):
    """Goes on where it stopped. Exit code 1 with results means cells that failed, which they name."""
    (folder / "statistics.json").unlink(missing_ok=True)
    code = subprocess.run([program, "evaluate", plan, "-o", folder, "-q", *more], stdout=subprocess.DEVNULL).returncode
    if code not in (0, 1) or not (folder / "statistics.json").exists():
        raise Failed(f"{plan} stopped with exit code {code}; the same command goes on")


def judge(program, folder):
    subprocess.run([program, "evaluate", "--statistics-only", folder, "-q"], check=True, stdout=subprocess.DEVNULL)


def trimmed(statistics):
    """What pages show of statistics.json; recordings by their names, wherever they lie."""
    results = [{"dump": Path(e["dump"]).stem, **{k: e[k] for k in ("spp", "threads", "sampler", "filter", "replicates")},
                "quantities": {q: e["quantities"][q] for q in QUANTITIES if q in e.get("quantities", {})}} for e in statistics["results"]]
    ratios = [{"dump": Path(c["dump"]).stem, **{k: c[k] for k in ("spp", "threads", "metric", "about")},
               "ranking": [{k: m[k] for k in ("sampler", "filter", "ratio")} for m in c["ranking"] if m.get("ratio")]}
              for c in statistics["conditions"] if c["metric"] in ("mse", "relmse")]
    claims = [{**c, "places": [{**p, "dump": Path(p["dump"]).stem} for p in c["places"]]} for c in statistics["claims"]]
    return in_digits({"version": statistics["version"], "claims": claims, "results": results, "conditions": ratios, **beside(statistics)}, DIGITS)


def beside(statistics):
    """Of a plan with a baseline of its own: means over the recordings, and the samples that a method needs for the baseline's error."""
    if statistics.get("baseline", "uniform + box") == "uniform + box":
        return {}
    overall = [{**{k: o[k] for k in ("spp", "sampler", "filter")}, "quantities": {q: o["quantities"][q] for q in ("energy_ratio", "cpu_total")},
                "ratios": {m: a["ratio"] for m, a in o.get("against_baseline", {}).items()}} for o in statistics["overall"]]
    needed = [{"dump": Path(c["dump"]).stem, **{k: c[k] for k in ("sampler", "filter", "needed")}}
              for c in statistics["curves"] if c["metric"] == "relmse" and c.get("needed")]
    return {"overall": overall, "needed": needed}


def cells_in(text):
    """{name: what is in it}, of a text of lines as cells/*.jsonl has them."""
    return {cell["cell"]: cell for cell in map(json.loads, text.splitlines())}


def cells_text(cells):
    """Lines with their checksums."""
    lines = []
    for cell in cells.values():
        ordered = {k: cell[k] for k in ("cell", "failed")} | {k: v for k, v in cell.items() if k != "crc32"}
        lines.append(checked(json.dumps(ordered, separators=(",", ":"))[1:]))
    return "".join(lines)


def checked(rest):
    """A line of cells/*.jsonl: its checksum, and what comes behind it."""
    return f'{{"crc32":"{zlib.crc32(rest.encode()):08x}",{rest}\n'


def small_cell(cell, of_group=False, claimed=HALVES):
    """of_group: of a scene that was recorded several times; its intervals are those of the recordings, not of counts and halves.
    `claimed`: metrics of which halves are kept, in the program's digits: of two methods that are alike the difference decides."""
    kept = {**{k: cell[k] for k in ("cell", "failed", "method", "version")},
            "fields": {k: rounded(v, DIGITS) for k, v in cell["fields"].items() if k in FIELDS}}
    if of_group:
        return kept
    halves = {k: v for k, v in cell.get("halves", {}).items() if k in claimed}
    return {**kept, **({"counts": cell["counts"]} if "counts" in cell else {}), **({"halves": halves} if halves else {})}


def claimed_halves(claims):
    """{method: metrics of which a claim about it needs the halves}; fresh samples are judged where the method's own have few pixels, too."""
    needed = {}
    for claim in claims:
        metric = claim.get("metric", "relmse")
        for side in ("better", "than"):
            needed.setdefault(claim[side], set()).update({metric, *([f"{metric}_fresh"] if claim.get("samples") == "fresh" else [])} & set(HALVES))
    return needed


def rounded(text, digits):
    """Of a number; other texts as they are."""
    try:
        return f"{float(text):.{digits}g}"
    except ValueError:
        return text


def pack(path, texts):
    """{name: text} as one compressed file, the same bytes for the same texts."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:xz", preset=9) as archive:
        for name, text in sorted(texts.items()):
            entry = tarfile.TarInfo(name)
            entry.size = len(text.encode())
            archive.addfile(entry, io.BytesIO(text.encode()))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, buffer.getvalue())


def unpack(path):
    """{name: text}; empty where nothing is kept yet."""
    if not path.exists():
        return {}
    try:
        with tarfile.open(path) as archive:
            return {member.name: archive.extractfile(member).read().decode() for member in archive if member.isfile()}
    except (tarfile.TarError, lzma.LZMAError, EOFError, UnicodeDecodeError) as reason:
        raise Failed(f"{path}: is cut or damaged ({reason}): git checkout it, or remove it and measure anew") from reason


def curves_of(statistics):
    return in_digits([{"dump": Path(c["dump"]).stem, **{k: c[k] for k in ("threads", "sampler", "filter", "equal_time")}}
                  for c in statistics["curves"] if c["metric"] == "relmse" and c.get("equal_time")], DIGITS)


def texts_of(folder):
    """What is kept of a folder whose recordings are in the tree: not its cells."""
    made = json.loads((folder / "made.json").read_text()) if (folder / "made.json").exists() else made_by(folder)
    statistics = json.loads((folder / "statistics.json").read_text())
    texts = {"made.json": json.dumps(made, indent=1) + "\n", "statistics.json": json.dumps(trimmed(statistics), separators=(",", ":"))}
    if curves := curves_of(statistics):
        texts["curves.json"] = json.dumps(curves, separators=(",", ":"))
    for name in ("plan.toml", "claims.json"):
        if (folder / name).exists():
            texts[name] = (folder / name).read_text(encoding="utf-8")
    return texts


def made_by(folder):
    manifest = json.loads((folder / "manifest.json").read_text())
    plan = manifest["plan"]
    described = sorted({m["name"] for kind in ("samplers", "filters") for m in plan[kind] if m.get("by_description")})
    return {"version": manifest["version"], "started": manifest["started"], "machine": manifest["machine"], "described": described,
            "dumps": [{"path": Path(d["path"]).name, "bytes": d["bytes"], "index_sha256": d["index_sha256"]} for d in manifest["dumps"]]}


def written(texts, folder):
    """The folder, with these files in it."""
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder

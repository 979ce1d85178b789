"""Plans on recordings of full size (dumps/POOLS.toml): measured one recording at a time, kept together, judged by the program.

Recordings are on no machine together, so a run adds those that are here and were not measured yet.
"""
import datetime
import hashlib
import json
import shutil
import subprocess

from tools.report.whole_file import write_whole
from tools.study import kept
from tools.study.plans import ROOT, full_plan, full_recording, full_recordings, group_of, text_of

CELLS = "cells/{}.jsonl"  # of a recording; "kept": of several


def plan_hash(plan):
    """Of what the plan measures, whatever it claims."""
    asked = {k: v for k, v in plan.items() if k not in ("recordings", "dump", "title", "claim", "pictures", "fresh")}
    return hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()[:16]


def commit():
    """Of the program's methods: the last that changed the library; the word "changed" where it is not committed."""
    def git(*arguments):
        return subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True).stdout.strip()
    return git("log", "-1", "--format=%h %cs", "--", "lib", "formats") + (
        " changed" if git("status", "--porcelain", "--untracked-files=no", "--", "lib", "formats") else "")


def lines_of(texts, names):
    """Results of an older program on these recordings."""
    return "".join(line for line in texts.get("kept.jsonl", "").splitlines(keepends=True) if json.loads(line)["dump"] in names)


class Store:
    """Measures, and keeps what was measured."""

    def __init__(self, program, scratch, folder, threads="0"):
        self.program, self.scratch, self.folder, self.threads = program, scratch, folder, threads
        self._hashes = scratch / "samples_sha256.json"

    def kept(self, plan):
        return self.folder / f"{plan}.tar.xz"

    def made(self, plan):
        """{recording: by which program, when, of which samples}"""
        return json.loads(kept.unpack(self.kept(plan)).get("made.json", "{}"))

    def samples_hash(self, path):
        """Computed once for each file (dumps/verify/content_hash.py)."""
        known = json.loads(self._hashes.read_text()) if self._hashes.exists() else {}
        key = f"{path.stem} {path.stat().st_size} {path.stat().st_mtime_ns}"
        if key not in known:
            from dumps.verify.content_hash import content_hash  # needs numpy
            known[key] = content_hash(path)
            self.scratch.mkdir(parents=True, exist_ok=True)
            write_whole(self._hashes, json.dumps(known))
        return known[key]

    def measure(self, plan, name, again=False):
        """False where the recording is not here, or nothing was to be done."""
        path = full_recording(self.program, name, self.scratch / "pools")
        if path is None:
            return False
        asked = full_plan(plan, [path])
        made = {"plan_sha256": plan_hash(asked), "samples_sha256": self.samples_hash(path)}
        before = self.made(plan).get(name, {})
        if not again and made.items() <= before.items() and not lines_of(kept.unpack(self.kept(plan)), {name}):
            return False
        print(f"{plan} on {name}", flush=True)
        folder = self.scratch / plan / f"{name}-{made['plan_sha256']}-{made['samples_sha256'][:8]}"  # another plan is another folder
        folder.parent.mkdir(parents=True, exist_ok=True)
        write_whole(folder.with_suffix(".toml"), text_of(asked))
        threads = () if "threads" in asked else ("--threads", self.threads)
        kept.evaluate(self.program, folder.with_suffix(".toml"), folder, *threads, *(["--force"] if again else []))
        by = kept.made_by(folder)
        made |= {"version": by["version"], "commit": commit(), "date": datetime.date.today().isoformat(), "described": by["described"],
                 "processor": by["machine"]["processor"], "hardware_threads": by["machine"]["threads"], "replicates": asked["replicates"]}
        self._add(plan, name, folder, made)
        return True

    def _add(self, plan, name, folder, made):
        """What is kept of this recording gives way to its cells; the whole is judged."""
        texts = kept.unpack(self.kept(plan))
        texts["kept.jsonl"] = lines_of(texts, {*full_recordings(plan)} - {name})
        claimed = kept.claimed_halves(full_plan(plan, []).get("claim", ()))
        cells = {}
        for file in sorted((folder / "cells").glob("*.jsonl")):
            cells |= {k: kept.small_cell(c, group_of(name) is not None, claimed.get(c["method"], ())) for k, c in kept.cells_in(file.read_text()).items()}
        others = kept.cells_in(texts.get(CELLS.format("kept"), ""))
        texts |= {CELLS.format("kept"): kept.cells_text({k: c for k, c in others.items() if k not in cells}), CELLS.format(name): kept.cells_text(cells)}
        texts["made.json"] = json.dumps({**json.loads(texts.get("made.json", "{}")), name: made}, indent=1) + "\n"
        if "claims.json" not in texts and not texts["kept.jsonl"]:
            texts["claims.json"] = (folder / "claims.json").read_text()
        self._judged(plan, texts)

    def judge(self, plan):
        """What is kept, by the plan and its claims as they are now."""
        if texts := kept.unpack(self.kept(plan)):
            self._judged(plan, texts)

    def _judged(self, plan, texts):
        made = json.loads(texts["made.json"])
        names = [n for n in full_recordings(plan) if n in made]
        if not names:
            return
        for name in (n for n in made if n not in names):  # a recording that the plan no longer names is dropped
            texts.pop(CELLS.format(name), None)
        texts["kept.jsonl"] = lines_of(texts, names)
        texts.pop("figures.json", None)  # means that an earlier version kept beside lines
        texts["made.json"] = json.dumps({n: made[n] for n in names}, indent=1) + "\n"
        texts["plan.toml"] = text_of(full_plan(plan, [f"{n}.spool" for n in names]))
        folder = self.scratch / plan / "kept"
        shutil.rmtree(folder, ignore_errors=True)
        kept.written(texts, folder)
        kept.judge(self.program, folder)
        texts["statistics.json"] = json.dumps(kept.trimmed(json.loads((folder / "statistics.json").read_text())), separators=(",", ":"))
        kept.pack(self.kept(plan), {k: v for k, v in texts.items() if v})

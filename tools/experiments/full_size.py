"""The plans of tools/plans on recordings of full size (dumps/POOLS.toml): `tools/dev.sh experiments --full`.

Each plan runs on one recording at a time, and what it gave is kept in the tree (measured.py): recordings are on no machine
together, so a run adds those that are here and were not measured yet. A plan keeps its methods and budgets, and gets what
tools/plans/full_size/PLAN.toml says in addition.
"""
import datetime
import hashlib
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import measured
from described import in_folder
from evaluation import evaluate
from whole_file import write_whole

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "dumps/verify"))
RECORDINGS = Path(os.environ.get("SPOOL_RECORDINGS", os.path.join(
    os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache")), "spool", "recordings")))
CYCLES = ("chess", "balls", "table", "caustic", "fireflies", "mist", "chess_sequence")  # under the same names in dumps/tiny
OTHERS = ("cornell_box_picture", "torus", "thin_lens", "matpreview")
REPLICATES = 4  # 256 x 256 pixels hold sixteen pictures of 64 x 64

# As tools/experiments/pools.py: (scene, pixels per side, samples per pixel, seed).
ANALYTIC = {
    "scene_s": ("scene_s", 256, 256, 5),
    "scene_s_fireflies": ("scene_s_fireflies", 256, 256, 5),
    "scene_s_512": ("scene_s", 512, 64, 6),
    "scene_s_fireflies_512": ("scene_s_fireflies", 512, 64, 6),
    **{f"scene_s_n{samples}": ("scene_s", 256, samples, 5) for samples in (32, 64, 128, 256)},
}
LARGER = {"scene_s_128": "scene_s_512", "scene_s_fireflies_128": "scene_s_fireflies_512"}
LEFT_OUT = ("first", "prototypes", "methods")  # of full size in docs/filters.md, or not about pictures of that size
MORE = {  # besides the plan's own recordings and those by others
    "a13_paper_tiles": ("scene_s", "chess_256", "table_256"),
    "e2_filters_over_budget": ("mist_256",),
    "e3_samplers_over_budget": ("balls_256", "mist_256", "caustic_256", "fireflies_256", "caustic_mitsuba_256", "chess_sequence_256",
                                "chess_long", "chess_512", "cornell_box_picture_512", "caustic_mitsuba_512"),
    "e4_directions": ("chess_256", "caustic_mitsuba_256", "chess_512", "cornell_box_picture_512"),
    "e5_density": ("scene_s",),
    "e9_chess": ("scene_s", "chess_sequence_256", "chess_512"),
    "e10_balls": ("table_256", "mist_256", "caustic_256", "fireflies_256", "caustic_mitsuba_256", "caustic_mitsuba_512"),
    "features": ("mist_256",),
    "tuning_full": ("caustic_mitsuba_256", "fireflies_256", "scene_s", "scene_s_fireflies"),
}
ALONE = ("a10_pool_size", "e11_error_over_budget", "e6_threads", "e7_tiles", "e8_tile_borders")  # on their own recordings only


def full_name(name):
    return f"{name}_256" if name in CYCLES else LARGER.get(name, name)


def recordings_of(plan):
    """Names of the recordings that the plan asks for, whether they are here or not."""
    own = [full_name(Path(path).stem) for path in tomllib.loads(plan.read_text())["recordings"]]
    more = () if plan.stem in ALONE else (*MORE.get(plan.stem, ()), *OTHERS)
    return list(dict.fromkeys([*own, *more]))


def additions_of(plan):
    """(keys, methods) that the plan gets at full size, as text."""
    path = plan.parent / "full_size" / plan.name
    text = path.read_text() if path.exists() else ""
    at = text.find("[[")
    return (text[:at], text[at:]) if at >= 0 else (text, "")


def plan_text(plan, file):
    """The plan on this file alone."""
    keys, methods = additions_of(plan)
    text = re.sub(r"^recordings = \[.*?\]$", lambda _: f'{keys}recordings = ["{file}"]', plan.read_text(), count=1, flags=re.M | re.S)
    text = re.sub(r"^replicates = \d+$", f"replicates = {REPLICATES}", text, count=1, flags=re.M)
    return re.sub(r"^pictures = true$", "pictures = false", text, count=1, flags=re.M) + methods


def plan_hash(text):
    """Of what the plan asks, whatever its recording and words."""
    plan = tomllib.loads(text)
    return hashlib.sha256(json.dumps({k: v for k, v in plan.items() if k not in ("recordings", "title")}, sort_keys=True).encode()).hexdigest()[:16]


def analytic_pool(program, folder, name):
    path = folder / f"{name}.spool"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        scene, side, samples, seed = ANALYTIC[name]
        subprocess.run([program, "synth", scene, "--size", str(side), "--samples", str(samples), "--seed", str(seed),
                        "-o", path, "-q"], check=True)
    return path


class Recordings:
    """Those that are here, with the hashes of their samples (dumps/verify/content_hash.py), which are computed once."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.store = folder / "samples_sha256.json"
        self.hashes = json.loads(self.store.read_text()) if self.store.exists() else {}

    def path(self, name):
        """None where it is not here."""
        if name in ANALYTIC:
            return analytic_pool(self.program, self.folder / "pools", name)
        path = RECORDINGS / f"{name}.spool"
        return path if path.exists() else None

    def hash(self, name):
        path = self.path(name)
        status = path.stat()
        key = f"{name} {status.st_size} {status.st_mtime_ns}"
        if key not in self.hashes:
            from content_hash import content_hash  # needs numpy
            self.hashes[key] = content_hash(path)
            self.folder.mkdir(parents=True, exist_ok=True)
            write_whole(self.store, json.dumps(self.hashes))
        return self.hashes[key]


def commit():
    """Of the program's methods: the last that changed the library; the word "changed" where it is not committed."""
    def git(*arguments):
        return subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True).stdout.strip()
    found = git("log", "-1", "--format=%h %cs", "--", "lib", "formats")
    return found + (" changed" if git("status", "--porcelain", "--untracked-files=no", "--", "lib", "formats") else "")


class Measuring:
    """Runs plans on recordings and keeps what they gave."""

    def __init__(self, program, plans, scratch, store, threads="0", again=False):
        """plans: folder of them; scratch: where `spool evaluate` writes; store: folder of what is kept."""
        self.program, self.plans, self.scratch, self.store = program, plans, scratch, store
        self.threads, self.again, self.recordings = threads, again, Recordings(program, scratch)

    def kept(self, plan, recording):
        return self.store / plan / f"{recording}.jsonl"

    def sources(self, plan):
        """What was ever measured of a plan, in the order of its recordings."""
        wanted = recordings_of(self.plans / f"{plan}.toml")
        return [self.kept(plan, name) for name in wanted if measured.read_head(self.kept(plan, name))]

    def missing(self, plan):
        return [name for name in recordings_of(self.plans / f"{plan}.toml") if not measured.read_head(self.kept(plan, name))]

    def current(self, plan, recording, text):
        """Whether what is kept is of this plan and these samples. Of a recording that is not here nobody can tell, and none can be made."""
        head = measured.read_head(self.kept(plan, recording))
        return bool(head) and not self.again and head["plan_sha256"] == plan_hash(text) and head["samples_sha256"] == self.recordings.hash(recording)

    def measure(self, plan, recording, density):
        """False where the recording is not here, or nothing was to be done."""
        file = self.recordings.path(recording)
        if file is None:
            return False
        text = plan_text(self.plans / f"{plan}.toml", file)
        if self.current(plan, recording, text):
            return False
        hashed, folder = plan_hash(text), self.scratch / plan / recording
        if (same := self._same_of_another(recording, hashed, density)) and not self.again:
            print(f"{plan} on {recording}: what {same.parent.name} measured", flush=True)
            measured.keep_as(same, plan, self.kept(plan, recording))
            return True
        target = folder / f"{hashed}-{self.recordings.hash(recording)[:8]}.toml"  # another plan or recording is another folder
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(target, text)
        print(f"{plan} on {recording}", flush=True)
        threads = "0" if re.search(r"^threads = ", text, flags=re.M) else self.threads  # such a plan says its threads itself
        evaluate(self.program, target, target.with_suffix(""), threads, *(["--force"] if self.again else []))
        head = {"plan": plan, "recording": recording, "samples_sha256": self.recordings.hash(recording), "plan_sha256": hashed,
                "replicates": REPLICATES, "described": sorted(in_folder(target.with_suffix(""))), **self._made_by(target.with_suffix(""))}
        if density:
            from density import densities  # needs numpy
            head["density"] = {f"{sampler}|{spp:g}": {k: [measured.short(v) for v in values] for k, values in found.items()}
                               for (_, sampler, spp), found in densities(self.program, target, target.with_suffix("")).items()}
        measured.keep(target.with_suffix(""), head, self.kept(plan, recording))
        return True

    def _same_of_another(self, recording, hashed, density):
        """What another plan that asks the same measured with this program, or None."""
        for path in sorted(self.store.glob(f"*/{recording}.jsonl")):
            head = measured.read_head(path)
            if head and (head["plan_sha256"], head["samples_sha256"], head["commit"], "density" in head) == (
                    hashed, self.recordings.hash(recording), commit(), bool(density)):
                return path
        return None

    def _made_by(self, folder):
        manifest = json.loads((folder / "manifest.json").read_text())
        return {"version": manifest["version"], "commit": commit(), "date": datetime.date.today().isoformat(),
                "processor": manifest["machine"]["processor"], "hardware_threads": manifest["machine"]["threads"]}


def density_of(sources):
    """{(pool, sampler, spp): {measure: [one per replicate]}} of what is kept."""
    found = {}
    for path in sources:
        head = measured.read_head(path)
        for key, measures in head.get("density", {}).items():
            sampler, spp = key.rsplit("|", 1)
            found[head["recording"], sampler, float(spp)] = measures
    return found

"""Images of single replays, for figures: made by the program into a folder, and judged by it (`spool metrics`)."""
import json
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import spool
import spool.exr


def rgb(path):
    layers = spool.exr.read(path)
    return np.stack([layers[c].astype(np.float64) for c in "RGB"], axis=-1)


def write_rgb(path, image):
    spool.exr.write(path, {c: np.ascontiguousarray(image[..., i], dtype=np.float32) for i, c in enumerate("RGB")})


def reference_of(recording):
    with spool.open(recording) as dump:
        values = np.asarray(dump.pixel("reference"), dtype=np.float64)
    values = np.moveaxis(values, 0, -1) if values.shape[0] == 3 else values
    return values[..., :3]


def errors(program, image, reference, variance=None, settings=()):
    """Every metric of an image by its name; variance: of the reference, which is taken off."""
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{name}.exr" for name in ("image", "reference", "variance")]
        for file, values in zip(files, (image, reference, variance)):
            if values is not None:
                write_rgb(file, values)
        more = [*(["--variance", files[2]] if variance is not None else []), *(word for s in settings for word in ("--set", s))]
        finished = subprocess.run([program, "metrics", files[0], files[1], "--json", *more], check=True, capture_output=True, text=True)
    return {name: found["value"] for name, found in json.loads(finished.stdout)["metrics"].items()}


def settings_of(kind, method):
    """(name with preset, --set arguments) of a method with options: name{a=1,b=2}."""
    name, _, options = method.partition("{")
    pairs = [part for part in options.removesuffix("}").split(",") if part]
    return name, [word for pair in pairs for word in ("--set", f"{kind}.{pair}")]


class Runs:
    """The program's files in a folder."""

    def __init__(self, program, recording, folder, spp, order="shuffled"):
        self.program, self.recording, self.folder, self.spp, self.order = program, recording, folder, str(spp), order

    def spool(self, *arguments):
        return subprocess.run([self.program, *arguments], check=True, capture_output=True, text=True).stdout

    def target(self, *words):
        """A file named by what it holds: what is there already is not made again."""
        return self.folder / (re.sub(r"[^\w.=-]+", "_", "-".join(map(str, words))) + ".exr")

    def replay(self, sampler, *more):
        """The counts, and views that `more` asks for."""
        name, settings = settings_of("sampler", sampler)
        target = self.target("counts", self.recording.stem, self.spp, sampler, *more)
        if not target.exists():
            self.spool("replay", self.recording, "--sampler", name, *settings, "--spp", self.spp, "--order", self.order, "-o", target, "-q", *more)
        return target

    def image(self, counts, filter_name, *more):
        name, settings = settings_of("filter", filter_name)
        target = self.target("image", counts.stem, filter_name)
        if not target.exists():
            self.spool("reconstruct", self.recording, "--selection", counts, "--filter", name, *settings, "-o", target, "-q", *more)
        return target

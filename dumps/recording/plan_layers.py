"""Which layers that will be recorded no method of a plan reads: what a recording could leave out, said before it is made."""
import json
import os
import re
import shutil
import subprocess

import tomllib

from dumps.recording.failure import io_failure, usage_failure

FEATURES = ("albedo", "normal", "depth")
ALWAYS = ("radiance",)
ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))


def program():
    for path in (os.environ.get("SPOOL"), os.path.join(ROOT, "build", "release", "spool"), shutil.which("spool")):
        if path and os.access(path, os.X_OK):
            return path
    raise io_failure("--plan needs the program spool, which is not built: tools/dev.sh build, or let SPOOL name it")


def needs_of_methods(kind):
    """{method: words on what it reads} of the program; kind: samplers or filters."""
    listed = subprocess.run([program(), "list", kind, "--json"], check=True, capture_output=True, text=True).stdout
    return {method["name"]: " ".join(method["needs"]) for method in json.loads(listed)}


def methods_of(plan, kind):
    """Names without preset, label and options; kind: sampler or filter."""
    for text in plan.get(kind + "s", []):
        yield text.partition("{")[0].rpartition("=")[2].partition(":")[0]
    for entry in plan.get(kind, []):
        yield entry["name"]


def read_by(path):
    """Layers that the plan's methods read where they are recorded."""
    try:
        with open(path, "rb") as stream:
            text = stream.read().decode()
        plan = tomllib.loads(text)
    except OSError as error:
        raise io_failure("--plan %s: %s" % (path, error.strerror))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise usage_failure("--plan %s: not a plan (%s)" % (path, error))
    words = "\n".join(needs_of_methods(kind + "s").get(name, "") for kind in ("sampler", "filter") for name in methods_of(plan, kind))
    layers = set(ALWAYS) | (set(FEATURES) if "albedo" in words else set())
    # An option of directional reads them, and pieces smaller than a pixel do.
    by_option = re.search(r"recon_granularity[^\n]*sample", text) or plan.get("pieces_per_side", 1) > 1
    return layers | ({"film"} if "film positions" in words or by_option else set())


def unread(plan, layers):
    """A line, or "" where the plan reads all of them."""
    wanted = read_by(plan)
    left = [name for name in layers if name not in wanted]
    return "no method of %s reads %s: --channels %s leaves them out" % (
        plan, ", ".join(left), ",".join(name for name in layers if name in wanted)) if left else ""

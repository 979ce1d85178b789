"""Several recordings of one scene in one go: they share the reference, and no seed."""
import hashlib
import json
import os
import shlex

from dumps.recording.failure import usage_failure

MOST = 64


def check_name(path):
    """Of a scene or a recording: it goes into lines of output and of JSON."""
    if any(ord(c) < 32 or ord(c) == 127 or 0xD800 <= ord(c) < 0xE000 for c in path or ""):
        raise usage_failure("%s: the name has a control character or is no UTF-8: rename it" % path)


def check(recordings, samples):
    if not 1 <= recordings <= MOST:
        raise usage_failure("--recordings %d is outside 1 .. %d" % (recordings, MOST))
    if samples % recordings:
        raise usage_failure("--recordings %d: %d samples do not split into %d equal parts: give --samples %d" % (
            recordings, samples, recordings, samples - samples % recordings or recordings))


def names(out, recordings):
    """NAME.spool, or NAME_1.spool, NAME_2.spool, ..."""
    stem, end = os.path.splitext(out)
    return [out] if recordings == 1 else ["%s_%d%s" % (stem, number, end) for number in range(1, recordings + 1)]


def group_meta(out, recordings, number, made_of):
    """What makes `spool evaluate` judge the files as one group; made_of: what is equal for all of them. number: from 0."""
    if recordings == 1:
        return {}
    digest = hashlib.sha256(json.dumps(made_of, sort_keys=True).encode()).hexdigest()
    name = "".join(c if c.isalnum() and c.isascii() or c in "_-." else "_" for c in os.path.splitext(os.path.basename(out))[0])
    return {"group": {"name": name[:64], "id": digest[:12], "recording": number + 1, "of": recordings}}


def next_step(paths):
    """What to type, as a shell takes it."""
    paths = [shlex.quote("./" + path if path.startswith("-") else path) for path in paths]
    return "next: spool evaluate %s --spp 4,8 --samplers uniform,multiscale --filters box,directional -o results" % " ".join(paths)

#!/usr/bin/env python3
"""Cuts a folder of passes into folders of several recordings, which share the reference: links, no copies.

    split.py FOLDER RECORDINGS NAME          FOLDER/recording_1, FOLDER/recording_2, ...

NAME is that of the recording; `spool pack` takes each folder for itself. Exit codes: 0 done, 1 the folder does not split, 3 the system refused.
"""
import json
import os
import shutil
import sys

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..")))

from dumps.recording.failure import guarded, scene_failure
from dumps.recording.recordings import group_meta


def split(folder, count, name):
    with open(os.path.join(folder, "manifest.json"), encoding="utf-8") as stream:
        manifest = json.load(stream)
    with open(os.path.join(folder, "passes.jsonl"), encoding="utf-8") as stream:
        lines = {(line["kind"], line["index"]): line for line in map(json.loads, stream)}   # a later one replaces an earlier one
    passes = sorted(index for kind, index in lines if kind == "pass")
    if len(passes) % count:
        raise scene_failure("%s: %d passes do not split into %d recordings: record with the --samples of before, or into another file" % (
            folder, len(passes), count))
    each = len(passes) // count
    reference = [line for (kind, _), line in lines.items() if kind == "reference"]
    made_of = [manifest["recording"], [lines["pass", index]["seed"] for index in passes], len(reference)]
    for number in range(count):
        part = os.path.join(folder, "recording_%d" % (number + 1))
        shutil.rmtree(part, ignore_errors=True)
        os.mkdir(part)
        own = [lines["pass", index] for index in passes[number * each:(number + 1) * each]] + reference
        for line in own:
            os.symlink(os.path.join("..", line["file"]), os.path.join(part, line["file"]))
        recording = {**manifest["recording"], **group_meta(name, count, number, made_of)}
        with open(os.path.join(part, "manifest.json"), "w", encoding="utf-8") as stream:
            json.dump({**manifest, "recording": recording}, stream)
        with open(os.path.join(part, "passes.jsonl"), "w", encoding="utf-8") as stream:
            stream.writelines(json.dumps(line) + "\n" for line in own)


if __name__ == "__main__":
    sys.exit(guarded(lambda: split(sys.argv[1], int(sys.argv[2]), sys.argv[3]), "split"))

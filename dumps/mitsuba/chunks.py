"""The folder of an unfinished recording: what was asked for, the chunks that are whole, the reference so far.

A chunk is some samples of every pixel, each layer compressed as a block of a file is, [c][y][x][s]: the disk holds about as much as the
file will. It is written under another name, flushed and renamed, so that a run killed at any moment loses the chunk it was rendering and
nothing else.
"""
import json
import os
import shutil
import sys
import zipfile
import zlib
from math import prod

import numpy as np

import spool
from dumps.mitsuba.channels import LAYERS
from dumps.recording import whole_files
from dumps.recording.failure import io_failure, usage_failure
from spool import SpoolError, chunk_codec
from spool.record_layout import FILTER_SHUFFLE

FORMAT = 2         # of a chunk; recordings begun with another one cannot go on
SHAPE = ".shape"   # behind a layer's name: an empty array [0][c][y][x][s] of its type


class Chunks:
    def __init__(self, folder, plan):
        """plan: everything that must be equal for two runs to continue each other."""
        self.folder = folder
        path = os.path.join(folder, "plan.json")
        try:
            os.makedirs(folder, exist_ok=True)
            self.lock = whole_files.lock(folder, "another recorder is writing here")
            if os.path.exists(path):
                found = self._plan(path)
                different = sorted(key for key in set(found) | set(plan) if found.get(key) != plan.get(key))
                if different:
                    raise usage_failure("%s: holds another recording (%s differs): finish that one, remove the "
                                        "folder, or choose another output" % (folder, different[0]))
            else:
                self._save("plan.json", lambda stream: stream.write(json.dumps(plan, indent=1).encode()))
        except OSError as error:
            raise io_failure("%s: %s" % (folder, error.strerror))

    def _plan(self, path):
        with open(path) as stream:
            try:
                return json.load(stream)
            except ValueError:
                raise io_failure("%s: damaged: remove the folder and run the same command again" % path)

    def has(self, index):
        return os.path.exists(self._name(index))

    def whole_name(self, number):
        """Of a recording that is written and not yet tested."""
        return os.path.join(self.folder, "whole_%d.spool" % (number + 1))

    def is_whole(self, number):
        return os.path.exists(self.whole_name(number))

    def forget(self, indices):
        """They go into the file now: the disk holds no sample twice. A run that is stopped before it is whole traces them again."""
        for index in indices:
            os.remove(self._name(index))

    def save_numbers(self, numbers, wish, marks):
        """marks: of the whole pool, sorted, or empty where they were counted before; with another reference they are asked for again when
        the chunks are gone."""
        if len(marks) and not os.path.exists(self._marks()):
            self._save(os.path.basename(self._marks()), lambda stream: np.save(stream, marks))
        self._save("numbers.json", lambda stream: stream.write(json.dumps({"wish": wish, "numbers": numbers}).encode()))

    def pool_marks(self, count):
        """Sorted, of all chunks."""
        if os.path.exists(self._marks()):
            return self._read_array(self._marks())
        return np.sort(np.concatenate([self.marks(index) for index in range(count)]))

    def load_numbers(self, wish, cut, layers, recordings):
        """What was counted before a file began to take the chunks, or None. wish: the reference; with another one the files that
        are whole give their samples back. cut: of one of the recordings."""
        path = os.path.join(self.folder, "numbers.json")
        if not os.path.exists(path):
            return None
        found = self._plan(path)
        if found["wish"] == wish:
            return found["numbers"]
        for number in range(recordings):
            if self.is_whole(number):
                self._take_back(number, cut, layers)
        os.remove(path)
        return None

    def _take_back(self, number, cut, layers):
        """The chunks of a file that is whole, then it goes: a run that is stopped in between does it again."""
        path, each = self.whole_name(number), len(cut.parts)
        with spool.open(path) as dump:
            narrow = [name for name in layers if dump.layers[name].dtype != np.dtype("<" + LAYERS[name][0])]
            if narrow or not os.path.exists(self._marks()):
                print("%s: is of another --reference, and %s: its samples are traced again" % (
                    path, "its %s has 16 bits" % narrow[0] if narrow else "of an earlier version"), file=sys.stderr)
            else:
                seconds = dump.meta["cost_per_sample"] * dump.width * dump.height * dump.spp / each
                for index, (first, count, rows) in enumerate(cut.parts, number * each):
                    self.save(index, np.empty(0, "<u8"), {name: dump.read(name, 0, rows[0], dump.width, rows[1], first, count)
                                                          for name in layers}, seconds)
        os.remove(path)

    def save(self, index, marks, layers, seconds):
        """marks: of shared_numbers; layers: {name: [y][x][s][c]}."""
        stored = {}
        for name, array in layers.items():
            planes = np.ascontiguousarray(array.transpose(3, 0, 1, 2))
            packed = chunk_codec.compress(planes.tobytes(), planes.itemsize)[2]
            stored[name] = np.frombuffer(packed, np.uint8)
            stored[name + SHAPE] = np.empty((0, *planes.shape), planes.dtype)
        self._save(os.path.basename(self._name(index)),
                   lambda stream: np.savez(stream, seconds=np.float64(seconds), marks=marks, **stored))

    def layers(self, index, names):
        """{name: [y][x][s][c]}"""
        path, found = self._name(index), {}
        stored = self._read(path, *names, *(name + SHAPE for name in names))
        for name in names:
            (_, *shape), dtype, raw = stored[name + SHAPE].shape, stored[name + SHAPE].dtype, stored[name].tobytes()
            size = prod(shape) * dtype.itemsize
            try:
                raw = raw if len(raw) == size else chunk_codec.decompress(raw, size, FILTER_SHUFFLE, dtype.itemsize)
            except SpoolError as error:
                raise self._damaged(path, error)
            found[name] = np.frombuffer(raw, dtype).reshape(shape).transpose(1, 2, 3, 0)
        return found

    def seconds(self, index):
        return float(self._read(self._name(index), "seconds")["seconds"])

    def marks(self, index):
        return self._read(self._name(index), "marks")["marks"]

    def light(self, index, names):
        """Values of these layers, whatever pixel and sample they are of."""
        return np.concatenate([array.ravel() for array in self.layers(index, names).values()])

    def save_reference(self, state):
        self._save("reference.npz", lambda stream: np.savez(stream, **state))

    def load_reference(self):
        path = os.path.join(self.folder, "reference.npz")
        return self._read(path) if os.path.exists(path) else None

    def mark_named(self):
        """The files of this recording get their names from now on: a run that is stopped then may replace those that have one."""
        self._save("named", lambda stream: None)

    def is_named(self):
        return os.path.exists(os.path.join(self.folder, "named"))

    def remove(self):
        shutil.rmtree(self.folder)

    def _marks(self):
        return os.path.join(self.folder, "marks.npy")

    def _read_array(self, path):
        try:
            return np.load(path)
        except (OSError, ValueError, EOFError) as error:
            raise self._damaged(path, error)

    def _read(self, path, *names):
        """{name: array}, of all names if none is given. A recorder never leaves half a file, but disks do."""
        try:
            with np.load(path) as stored:
                return {name: stored[name] for name in names or stored.files}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as error:
            raise self._damaged(path, error)

    def _damaged(self, path, error):
        return io_failure("%s: damaged (%s): remove it and run the same command again" % (path, str(error).split("\n")[0]))

    def _name(self, index):
        return os.path.join(self.folder, "chunk_%05d.npz" % index)

    def _save(self, name, write):
        whole_files.save(os.path.join(self.folder, name), write,
                         lambda error: ": make room and run the same command again, it goes on where it stopped")

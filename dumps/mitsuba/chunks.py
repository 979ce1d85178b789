"""The folder of an unfinished recording: what was asked for, the chunks that are whole, the reference so far.

A chunk is some samples of every pixel. It is written under another name, flushed and renamed, so that a
run killed at any moment loses the chunk it was rendering and nothing else.
"""
import fcntl
import json
import os
import shutil
import zipfile
import zlib

import numpy as np

from failure import io_failure, usage_failure


class Chunks:
    def __init__(self, folder, plan):
        """plan: everything that must be equal for two runs to continue each other."""
        self.folder = folder
        path = os.path.join(folder, "plan.json")
        try:
            os.makedirs(folder, exist_ok=True)
            self._lock(os.path.join(folder, ".lock"))
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

    def _lock(self, path):
        """Held as long as this process lives: two recorders would write over each other."""
        self.lock = open(path, "w")
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise usage_failure("%s: another recorder is writing here" % self.folder)

    def has(self, index):
        return os.path.exists(self._name(index))

    def whole_name(self, number):
        """Of a recording that is written and not yet tested."""
        return os.path.join(self.folder, "whole_%d.spool" % (number + 1))

    def is_whole(self, number):
        return os.path.exists(self.whole_name(number))

    def forget(self, indices):
        """They are in the file now: the disk holds no sample twice. A run that is stopped before it is whole traces them again."""
        for index in indices:
            os.remove(self._name(index))

    def save_numbers(self, numbers, wish):
        self._save("numbers.json", lambda stream: stream.write(json.dumps({"wish": wish, "numbers": numbers}).encode()))

    def load_numbers(self, wish):
        """What was counted before a file began to take the chunks, or None. wish: the reference; with another one the files that
        are whole are of no use."""
        path = os.path.join(self.folder, "numbers.json")
        if not os.path.exists(path):
            return None
        found = self._plan(path)
        if found["wish"] == wish:
            return found["numbers"]
        for name in os.listdir(self.folder):
            if name.startswith("whole_"):
                os.remove(os.path.join(self.folder, name))
        os.remove(path)
        return None

    def save(self, index, arrays, seconds):
        self._save(os.path.basename(self._name(index)),
                   lambda stream: np.savez(stream, seconds=np.float64(seconds), **arrays))

    def load(self, index):
        """(arrays, seconds)"""
        arrays = self._read(self._name(index))
        return arrays, float(arrays.pop("seconds"))

    def part(self, index, name):
        """One array of a chunk."""
        return self._read(self._name(index), name)[name]

    def largest(self, indices):
        """The largest finite magnitude of their radiance."""
        found = 0.0
        for index in indices:
            radiance = self.part(index, "radiance")
            found = max(found, float(np.abs(radiance, where=np.isfinite(radiance), out=np.zeros_like(radiance)).max()))
        return found

    def save_reference(self, state):
        self._save("reference.npz", lambda stream: np.savez(stream, **state))

    def load_reference(self):
        path = os.path.join(self.folder, "reference.npz")
        if not os.path.exists(path):
            return None
        return self._read(path)

    def own(self, path):
        return os.path.dirname(path) == self.folder

    def claim(self, path):
        """Before this file is written: what lies under its partial name is of this recording from now on, and a run that was
        stopped while it wrote the file has left it. What lay there before belongs to somebody else; the writer refuses it."""
        mark, partial = os.path.join(self.folder, "file_begun"), path + ".partial"
        try:
            if not os.path.exists(mark) and not self.own(path):
                if not os.path.lexists(partial):
                    open(mark, "w").close()
            elif os.path.lexists(partial):
                os.remove(partial)
        except OSError as error:
            raise io_failure("%s: %s" % (error.filename, error.strerror))

    def mark_named(self):
        """The files of this recording get their names from now on: a run that is stopped then may replace those that have one."""
        self._save("named", lambda stream: None)

    def is_named(self):
        return os.path.exists(os.path.join(self.folder, "named"))

    def remove(self):
        shutil.rmtree(self.folder)

    def _read(self, path, *names):
        """{name: array}, of all names if none is given. A recorder never leaves half a file, but disks do."""
        try:
            with np.load(path) as stored:
                return {name: stored[name] for name in names or stored.files}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as error:
            raise io_failure("%s: damaged (%s): remove it and run the same command again" % (path, str(error).split("\n")[0]))

    def _name(self, index):
        return os.path.join(self.folder, "chunk_%05d.npz" % index)

    def _save(self, name, write):
        path = os.path.join(self.folder, name)
        try:
            with open(path + ".writing", "wb") as stream:
                write(stream)
                stream.flush()
                os.fsync(stream.fileno())
            os.replace(path + ".writing", path)
        except OSError as error:
            if os.path.exists(path + ".writing"):
                os.remove(path + ".writing")
            raise io_failure("%s: %s: make room and run the same command again, it goes on where it stopped"
                             % (path, error.strerror))

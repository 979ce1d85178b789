"""The folder of a recording: manifest.json, passes.jsonl, one file per pass (see ../passes.md).

A pass counts once its line stands in passes.jsonl, and the line is written after the file is whole,
flushed and renamed. So a run killed at any moment leaves a valid smaller recording.
"""
import errno
import json
import os
import zlib

from dumps.cycles import packed_pass
from dumps.recording import whole_files
from dumps.recording.failure import Failure, io_failure, usage_failure

# a full disk, a full quota, a limit on the size of files
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
FORMAT, VERSION = "spool-passes", 1
FILES = {"pass": "pass_%05d.f32", "reference": "reference_%05d.f32"}


class PassFolder:
    """recording: everything that must be equal for passes to belong together. packed: a recording has taken the passes, the log stays as it is."""

    def __init__(self, path, recording, packed=False):
        self.path = path
        self.size = recording["width"], recording["height"]
        self.entries = {kind: {} for kind in FILES}
        try:
            os.makedirs(path, exist_ok=True)
            self.lock = whole_files.lock(path, "another recorder is writing here")
            self._open_manifest(recording)
            self._open_log(packed)
        except OSError as error:
            raise io_failure("%s: %s%s" % (path, error.strerror, hint_of(error)))

    def has(self, kind, index):
        return index in self.entries[kind]

    def add(self, kind, index, data, entry):
        """data: float32 [channel][y][x]. entry: what the log keeps besides index, file and crc32."""
        line = self._write_file(kind, index, FILES[kind] % index, data, entry)
        try:
            whole_files.write_synced(self._name("passes.jsonl"), "ab", lambda stream: stream.write((json.dumps(line) + "\n").encode()))
        except OSError as error:
            raise io_failure("%s: %s%s" % (self._name("passes.jsonl"), error.strerror, hint_of(error)))
        self.entries[kind][index] = line

    def batch(self, index):
        """float32 [channel][y][x] of a batch of the reference."""
        line = self.entries["reference"][index]
        with open(self._name(line["file"]), "rb") as stream:
            return packed_pass.unpack(stream.read(), line, *self.size, planes=3)

    def replace(self, kind, files, names):
        """files: [(data, entry)], in the place of all of this kind; names: with a %d, of no file that is there."""
        old = list(self.entries[kind])
        before = [self.entries[kind][index]["file"] for index in old]
        lines = [self._write_file(kind, index, names % index, data, entry) for index, (data, entry) in enumerate(files)]
        self.entries[kind].clear()
        self.entries[kind].update(enumerate(lines))
        self._write_log(before)

    def _write_file(self, kind, index, name, data, entry):
        """Returns its line for the log."""
        data, codec = packed_pass.pack(data, *self.size)
        self._save(name, data)
        return dict(kind=kind, index=index, file=name, crc32=zlib.crc32(data), **codec, **entry)

    def remove(self, kind, indices):
        """Takes passes out: the log first, in one step, so that a kill in between leaves files without a line."""
        self._write_log([self.entries[kind].pop(index)["file"] for index in indices])

    def _write_log(self, files):
        """The log of what is there, in one step; then the files go that it no longer names."""
        lines = [json.dumps(line) + "\n" for entries in self.entries.values() for line in entries.values()]
        self._save("passes.jsonl", "".join(lines).encode())
        for file in files:
            os.remove(self._name(file))

    def _save(self, name, data):
        whole_files.save(self._name(name), lambda stream: stream.write(data), hint_of)

    def _name(self, name):
        return os.path.join(self.path, name)

    def _open_manifest(self, recording):
        name = self._name("manifest.json")
        # through text, so that what is compared is what a file can hold
        recording = json.loads(json.dumps(recording))
        if not os.path.exists(name):
            manifest = {"format": FORMAT, "version": VERSION, "recording": recording}
            return self._save("manifest.json", (json.dumps(manifest, indent=1) + "\n").encode())
        try:
            with open(name, "rb") as stream:
                manifest = json.load(stream)
            found = manifest["recording"]
            if (manifest["format"], manifest["version"]) != (FORMAT, VERSION):
                raise ValueError("format or version")
        except (ValueError, KeyError, TypeError) as error:
            raise Failure(1, "%s: not a manifest of recorded passes (%s): remove the folder or choose "
                             "another" % (name, error))
        difference = first_difference(found, recording)
        if difference:
            raise usage_failure("%s: holds another recording (%s): choose another folder" %
                                (self.path, difference))

    def _open_log(self, packed):
        """Keeps the lines whose file is whole, and cuts off a torn last line. Lines without a file leave the log too: `spool pack`
        would ask for passes that nobody renders again."""
        name = self._name("passes.jsonl")
        if not os.path.exists(name):
            return
        with open(name, "rb") as stream:
            content = stream.read()
        whole = content[:content.rfind(b"\n") + 1]
        if len(whole) != len(content):
            os.truncate(name, len(whole))
        lost = False
        for number, text in enumerate(whole.splitlines(), 1):
            try:
                line = json.loads(text)
                kind, index = line["kind"], line["index"]
                if self._is_whole(line):
                    self.entries[kind][index] = line
                else:
                    self.entries[kind].pop(index, None)
                    lost = True
            except (ValueError, KeyError, TypeError):
                raise Failure(1, "%s: line %d is damaged: remove the line, its pass is rendered again"
                              % (name, number))
        if lost and not packed:
            self._write_log([])

    def _is_whole(self, line):
        try:
            with open(self._name(line["file"]), "rb") as stream:
                return zlib.crc32(stream.read()) == line["crc32"]
        except FileNotFoundError:
            return False


def hint_of(error):
    return ": free some space and run the same command again, it goes on where it stopped" \
        if error.errno in FULL else ""


def first_difference(old, new, path=""):
    """`key: OLD there, NEW here` of the first key that differs, or an empty text."""
    for key in sorted(set(old) | set(new)):
        a, b = old.get(key), new.get(key)
        if isinstance(a, dict) and isinstance(b, dict):
            inner = first_difference(a, b, path + key + ".")
            if inner:
                return inner
        elif a != b:
            return "%s%s: %s there, %s here" % (path, key, json.dumps(a), json.dumps(b))
    return ""

"""The folder of the figures: all files of a run appear together, or none does."""

import os
import secrets
import shutil

from tools.report.failure import IO, USAGE, Failure


class FigureFolder:
    """Files are made in `staging`, a folder inside, and renamed when the `with` block ends without an error: a link
    of the same name is replaced, not followed."""

    def __init__(self, path, force):
        self.path, self.force, self.names = path, force, []

    def __enter__(self):
        self.staging = self.path / f".figure.{secrets.token_hex(8)}.partial"
        self.guard = _remove_when_this_ends(self.staging, None if self.path.exists() else self.path)
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self.staging.mkdir(mode=0o700)
        except OSError as error:
            self.guard()
            raise self._failure(error) from error
        return self

    def __exit__(self, _, error, __):
        try:
            if error is None:
                for name in self.names:
                    os.replace(self.staging / name, self.path / name)
            elif isinstance(error, OSError):  # of a full disk: no library names the file
                raise self._failure(error) from error
        except OSError as late:
            raise self._failure(late) from late
        finally:
            self.guard()

    def file(self, name):
        """Where to write the file that gets this name; nothing is replaced unasked."""
        assert name not in self.names, f"{name}: written twice"  # else renamed twice, after others appeared
        target = self.path / name
        if os.path.lexists(target) and (not self.force or (target.is_dir() and not target.is_symlink())):
            raise Failure(f"{target}: exists: choose another folder" + ("" if self.force else " or give --force"), USAGE)
        self.names.append(name)
        return self.staging / name

    def text(self, name, text):
        path = self.file(name)
        path.write_text(text, encoding="utf-8")
        return path

    def pictures(self, name):
        """Where to write the figure of this name, without the endings that draw_curves.save appends."""
        return [self.file(f"{name}.{kind}") for kind in ("pdf", "svg", "png")][0].with_name(name)

    def _failure(self, error):
        return Failure(f"{self.path}: {error.strerror or error}: choose another folder", IO)


def _remove_when_this_ends(staging, made):
    """A function that removes `staging`, and `made` where it is empty. So does a process of its own when this one is
    killed without a word, as an interrupted spool does with what it started: it reads from a pipe that then ends."""
    reading, writing = os.pipe()
    waiting, ready = os.pipe()
    child = os.fork()
    if child:
        os.close(reading)
        os.close(ready)
        os.read(waiting, 1)  # until the other is in a group of its own, which no interrupt ends
        os.close(waiting)

        def remove():
            os.close(writing)
            os.waitpid(child, 0)
        return remove
    try:
        os.setsid()
        os.close(ready)
        os.close(writing)
        os.read(reading, 1)
        shutil.rmtree(staging, ignore_errors=True)
        if made:
            made.rmdir()  # an error where it holds figures
    finally:
        os._exit(0)

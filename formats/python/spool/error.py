"""The one exception of this package: one line "FILE: what (where): what to do"; and the opening of files, which is refused with it.

`kind` is the class of failure in section 7 of the specification, or one of this package: "usage" (unknown layer, range
outside the image, target exists), "absent" (a block that was never recorded), "missing_package", "data" (it can be read
and not used). `code` is the exit code of the program `spool` for it.
"""
import os
import re
import stat

DATA, USAGE, IO, DAMAGE = 1, 2, 3, 4

CODE_OF_KIND = {"not_spool": DATA, "unsupported": DATA, "invalid": DATA, "absent": DATA, "data": DATA, "usage": USAGE,
                "missing_package": USAGE, "io": IO, "incomplete": DAMAGE, "damaged": DAMAGE}

ADVICE = {"not_spool": "give a .spool file, or import it with spool pack --from", "unsupported": "use a newer reader",
          "invalid": "the writer is at fault, record again", "absent": "ask for fewer samples or record them",
          "incomplete": "run spool recover", "damaged": "run spool recover"}


LONGEST = 380            # characters of a line; with the name of a program before it at most 400


def one_line(text):
    """Bounded, without what a terminal obeys: its beginning, which names the file, and its end, where the remedy stands."""
    text = "".join(c if c.isprintable() else " " if c in "\n\t" else repr(c)[1:-1] for c in str(text))
    return text if len(text) <= LONGEST else f"{text[:LONGEST // 2]} [...] {text[7 - LONGEST // 2:]}"


class SpoolError(Exception):
    # Options of the program, which of_code names as parameters of Python's functions.
    options = ((re.compile(r"(?<!\S)--force\b"), "force=True"),
               (re.compile(r"(?<!\S)--(set |(?=(views|preset|spp|filter|holdout|reference)\b))"), ""))

    def __init__(self, kind, message):
        message = one_line(message)
        super().__init__(message)
        self.kind = kind
        self.message = message

    def __reduce__(self):  # two arguments, which pickle cannot know
        return type(self), (self.kind, self.message)

    @classmethod
    def of_code(cls, code, message):
        """The error of an exit code and the program's line, where nothing more is known."""
        for option, parameter in cls.options:
            message = option.sub(parameter, message)
        return cls({DATA: "data", USAGE: "usage", IO: "io", DAMAGE: "damaged"}[code], message)

    @property
    def code(self):
        return CODE_OF_KIND[self.kind]


def open_regular(path, mode="rb", **how):
    """As the built-in open, of a file on disk alone: a FIFO without a writer is not waited for."""
    return open(path, mode, opener=_opened, **how)


def _opened(path, flags):
    handle = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    if stat.S_ISREG(os.fstat(handle).st_mode):
        return handle
    os.close(handle)
    raise SpoolError("io", f"{path}: not a regular file: check the path")

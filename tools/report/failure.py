"""The one exception of report and figures, a line for the user and an exit code; and files of a folder from elsewhere, opened."""

import os
import stat
import sys
from pathlib import Path

DATA, USAGE, IO = 1, 2, 3


class Failure(Exception):
    """`message` is one line: FILE: what: what to do. `code` is that of the program spool."""

    def __init__(self, message, code=DATA):
        super().__init__(message)
        self.code = code


def guarded(work):
    """Prints what `work` returns, or its failure as one line on stderr; the exit code."""
    try:
        print(work())
    except Failure as failure:
        print(_one_line(str(failure)), file=sys.stderr)
        return failure.code
    except OSError as error:
        print(f"{error.filename or 'output'}: {error.strerror}: choose another place", file=sys.stderr)
        return IO
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        # Every reader checks what it reads; what gets past them is still no page.
        print("the files of the folder do not fit together as those of one evaluation do "
              f"({_place_of(error)}): run spool evaluate again", file=sys.stderr)
        return DATA
    return 0


def _one_line(text):
    """What the program hands on: a field of a file may contain line ends."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)[:400]


def _place_of(error):
    """Where the generator gave up, for a report of the fault."""
    frame = error.__traceback__
    while frame.tb_next is not None:
        frame = frame.tb_next
    return f"{Path(frame.tb_frame.f_code.co_filename).name}, line {frame.tb_lineno}"


def open_regular(path, **how):
    """A text file for reading: a FIFO or a device in its place is not waited for."""
    return open(path, encoding="utf-8", opener=_opened, **how)


def _opened(path, flags):
    handle = os.open(path, flags | os.O_NONBLOCK)  # a FIFO without a writer must not hang us
    if stat.S_ISREG(os.fstat(handle).st_mode):
        return handle
    os.close(handle)
    raise Failure(f"{path}: is no regular file: delete it", IO)

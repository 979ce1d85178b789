"""The one exception of the recorder: a line for stderr and the exit code of the program.

1 the scene cannot be recorded, 2 wrong use, 3 the operating system or the renderer refused.
"""
import os
import signal
import sys

LONGEST = 380            # characters of a line; with the name of a program before it at most 400


def one_line(text):
    """Bounded: its beginning, which names the file, and its end, where the remedy stands. What a terminal obeys is an escape."""
    text = "".join(c if c.isprintable() else " " if c in "\n\t" else repr(c)[1:-1] for c in str(text))
    return text if len(text) <= LONGEST else "%s [...] %s" % (text[:LONGEST // 2], text[7 - LONGEST // 2:])


class Failure(Exception):
    def __init__(self, code, message):
        super().__init__(one_line(message))
        self.code = code


def scene_failure(message):
    return Failure(1, message)


def usage_failure(message):
    return Failure(2, message)


def io_failure(message):
    return Failure(3, message)


def guarded(work, name="", resumable=False):
    """The exit code that `work` returns (None: 0), or that of its failure, which becomes one line. name: of the program, before it.
    resumable: an interrupted command goes on when it is given again."""
    before = name + ": " if name else ""
    try:
        code = work() or 0
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # the reader, `head` for example, has what it wanted: ended as by the signal
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 128 + signal.SIGPIPE
    except KeyboardInterrupt:
        if not resumable:
            raise
        line, code = "stopped: run the same command again to go on", 3
    except OSError as error:
        line, code = one_line("%s%s: %s" % (before, error.filename, error.strerror)), 3
    except Exception as error:
        line, code = "%s%s" % (before, error), getattr(error, "code", None)
        if not isinstance(code, int):          # neither a Failure nor a SpoolError
            raise
    print(line, file=sys.stderr)
    return code


def module_failure(error, purpose, script):
    """error: the ImportError of a module of Debian's Python that the Python at work lacks."""
    return io_failure("%s has no %s, which %s: apt-get install python3-numpy python3-zstandard and run /usr/bin/python3 %s" % (
        sys.executable, error.name, purpose, script))

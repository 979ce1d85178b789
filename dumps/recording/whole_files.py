"""A folder that one recorder writes to, and files in it that appear whole or not at all."""
import os

try:
    import fcntl
except ImportError:                        # not on this system: two recorders at once go unnoticed
    fcntl = None

from dumps.recording.failure import io_failure, usage_failure


def lock(folder, refusal):
    """A file that keeps another process out as long as it is open: two recorders would write over each other."""
    stream = open(os.path.join(folder, ".lock"), "w")
    try:
        if fcntl:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise usage_failure("%s: %s" % (folder, refusal))
    return stream


def write_synced(path, mode, write):
    """write: a function of the open file."""
    with open(path, mode) as stream:
        write(stream)
        stream.flush()
        os.fsync(stream.fileno())


def save(path, write, hint):
    """hint: a function of an error of the system, what its line ends with."""
    part = path + ".partial"
    try:
        write_synced(part, "wb", write)
        os.replace(part, path)
    except OSError as error:
        if os.path.exists(part):
            os.remove(part)
        raise io_failure("%s: %s%s" % (path, error.strerror, hint(error)))

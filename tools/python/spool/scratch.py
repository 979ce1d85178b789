"""A folder for what lasts as long as a call or its result."""
import tempfile

from .error import SpoolError


def scratch_folder() -> tempfile.TemporaryDirectory:
    try:
        return tempfile.TemporaryDirectory(prefix="spool-")
    except OSError as reason:
        raise SpoolError("io", f"{tempfile.tempdir or 'temporary folder'}: {reason.strerror}: free some space there, or set TMPDIR to another") from None

"""The one exception of the report: a line for the user and an exit code."""

DATA, USAGE, IO = 1, 2, 3
NO_NUMPY = 20  # not an exit code of spool: another Python may do


class Failure(Exception):
    """`message` is one line: FILE: what: what to do. `code` is that of the program spool."""

    def __init__(self, message, code=DATA):
        super().__init__(message)
        self.code = code

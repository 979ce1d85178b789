"""Checks a whole file: opening, then payload CRC, pad bytes and decoding of every record."""
from dataclasses import dataclass, field

from .error import SpoolError
from .reader import Dump


@dataclass
class Report:
    """errors: every SpoolError found; lost: (group, tile, first sample) of the blocks that do not verify."""

    path: str
    records: int = 0
    blocks: int = 0
    complete: bool = False
    errors: list = field(default_factory=list)
    lost: list = field(default_factory=list)

    @property
    def ok(self):
        return not self.errors

    def __str__(self):
        if self.ok:
            return f"{self.path}: {self.blocks} blocks verified{'' if self.complete else ', some never recorded'}"
        return "\n".join(error.message for error in self.errors)


def check(path):
    """Never raises for what the file holds; the report says it."""
    report = Report(str(path))
    try:
        dump = Dump(path)
    except SpoolError as reason:
        report.errors.append(reason)
        return report
    with dump:
        report.records, report.complete = dump.record_count, dump.complete
        report.blocks = len(dump.blocks())
        for row, key in dump.every_record():
            try:
                dump.verify(row)
            except SpoolError as reason:
                report.errors.append(reason)
                if key is not None:
                    report.lost.append(key)
    return report

"""Progress: how much is done and how long the rest takes; a bar on a terminal, a line a minute in a log file."""
import os
import sys
import time

LOG_SECONDS = 60.0


class Progress:
    """On stderr."""

    def __init__(self, label, total):
        self.label, self.total = label, total
        self.shown = sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self.start, self.done = time.monotonic(), 0
        self.last = 0.0 if self.shown else self.start

    def step(self):
        self.done += 1
        now = time.monotonic()
        passed = now - self.last
        if passed < 0.2 and self.done < self.total if self.shown else passed < LOG_SECONDS:
            return
        self.last = now
        left = (now - self.start) / self.done * (self.total - self.done)
        text = "%s %d of %d, %s left" % (self.label, self.done, self.total, duration(left))
        sys.stderr.write("\r%s \033[K" % text if self.shown else text + "\n")
        sys.stderr.flush()

    def close(self):
        if self.shown and self.done:
            sys.stderr.write("\r\033[K")
            sys.stderr.flush()


def duration(seconds):
    seconds = int(seconds + 0.5)
    if seconds < 60:
        return "%d s" % seconds
    if seconds < 3600:
        return "%d min %02d s" % divmod(seconds, 60)
    return "%d h %02d min" % (seconds // 3600, seconds % 3600 // 60)


def size(count):
    for unit in ("bytes", "kB", "MB"):
        if count < 1000:
            return "%.3g %s" % (count, unit)
        count /= 1000
    return "%.3g GB" % count

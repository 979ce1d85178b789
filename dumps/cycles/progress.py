"""Progress on a terminal: a bar that says how much is done and how long the rest takes."""
import sys
import time


class Progress:
    """Silent unless stderr is a terminal."""

    def __init__(self, label, total, enabled=True):
        self.label, self.total = label, total
        self.shown = enabled and sys.stderr.isatty()
        self.start, self.last, self.done = time.monotonic(), 0.0, 0

    def step(self):
        self.done += 1
        now = time.monotonic()
        if not self.shown or (now - self.last < 0.2 and self.done < self.total):
            return
        self.last = now
        left = (now - self.start) / self.done * (self.total - self.done)
        sys.stderr.write("\r%s %d of %d, %s left \033[K" %
                         (self.label, self.done, self.total, duration(left)))
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

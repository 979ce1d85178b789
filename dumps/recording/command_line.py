"""Command lines whose errors are one line, where argparse would print the usage before it."""
import argparse
import os
import sys

from dumps.recording.failure import usage_failure
from dumps.recording.recordings import check as check_recordings
from dumps.recording.reference_need import parse_reference


class Parser(argparse.ArgumentParser):
    def error(self, message):
        dashed = [text for text in sys.argv[1:] if text.startswith("-") and os.path.exists(text)]
        more = "is %s a name? write ./%s" % (dashed[0], dashed[0]) if dashed else "--help lists the options"
        raise usage_failure("%s (%s)" % (message, more))


def take_shared(options, least):
    """Of both recorders: texts become values. least: pixels along a side."""
    for folder in options.files:
        if not os.path.isdir(folder):
            raise usage_failure("--files %s: no such folder" % folder)
    options.size = parse_size(options.size, least, 65536) if options.size else None
    options.substitutes = pairs("--substitute", options.substitute)
    options.reference, options.auto = parse_reference(options.reference)
    check_recordings(options.recordings, options.samples)


def pairs(option, texts):
    for text in texts:
        if "=" not in text or text.startswith("="):
            raise usage_failure("%s %s: write NAME=VALUE" % (option, text))
    return dict(text.partition("=")[::2] for text in texts)


def parse_size(text, least, most):
    """(width, height) of "WxH" or "N", each within the bounds."""
    parts = text.lower().split("x")
    try:
        width, height = (int(part) for part in (parts * 2)[:2])
        if len(parts) > 2 or not (least <= width <= most and least <= height <= most):
            raise ValueError
    except ValueError:
        raise usage_failure("--size '%s' is no size: use WxH or N, %d to %d" % (text, least, most))
    return width, height

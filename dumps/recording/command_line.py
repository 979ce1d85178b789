"""Command lines whose errors are one line, where argparse would print the usage before it."""
import argparse
import os
import sys

from dumps.recording.failure import usage_failure


class Parser(argparse.ArgumentParser):
    def error(self, message):
        dashed = [text for text in sys.argv[1:] if text.startswith("-") and os.path.exists(text)]
        more = "is %s a name? write ./%s" % (dashed[0], dashed[0]) if dashed else "--help lists the options"
        raise usage_failure("%s (%s)" % (message, more))


def pairs(option, texts):
    for text in texts:
        if "=" not in text or text.startswith("="):
            raise usage_failure("%s %s: write NAME=VALUE" % (option, text))
    return dict(text.partition("=")[::2] for text in texts)

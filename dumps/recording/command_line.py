"""Command lines whose errors are one line, where argparse would print the usage before it."""
import argparse

from failure import usage_failure


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise usage_failure("%s (--help lists the options)" % message)


def pairs(option, texts):
    for text in texts:
        if "=" not in text or text.startswith("="):
            raise usage_failure("%s %s: write NAME=VALUE" % (option, text))
    return dict(text.partition("=")[::2] for text in texts)

"""Command lines whose errors are one line, where argparse would print the usage before it."""
import argparse

from failure import usage_failure


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise usage_failure("%s (--help lists the options)" % message)

"""Figures and tables for a paper from the folder that `spool evaluate` wrote.

usage: run.py figure DIR -o FOLDER [--metric relmse] [--spp 8] [--recording NAME]... [--method "sampler + filter"]...
       [--crops [RECORDING:]X,Y,W,H]... [--column 1|2] [--font latex[:PACKAGE]] [--force]
Needs Python 3.9, numpy and matplotlib. Errors are one line on stderr; exit codes are those of spool.
"""

import argparse
import re
import shutil
from pathlib import Path

from tools.report.failure import USAGE, Failure, guarded
from tools.report.figure_set import FigureSet


def main(arguments=None):
    return guarded(lambda: make_figures(parse(arguments)))


def parse(arguments):
    parser = argparse.ArgumentParser(prog="spool figure", description=__doc__.split("\n", 1)[0])
    parser.add_argument("folder", type=Path, help="what spool evaluate -o DIR wrote")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder of the figures")
    parser.add_argument("--metric", default="")
    parser.add_argument("--spp", type=float, default=0.0, help="budget of the comparison (the largest)")
    parser.add_argument("--recording", action="append", default=[], help="compare on this one; may be repeated")
    parser.add_argument("--method", action="append", default=[], help="'sampler + filter', in this order")
    parser.add_argument("--crops", action="append", default=[], help="[RECORDING:]X,Y,W,H; may be repeated")
    parser.add_argument("--column", type=int, default=0, choices=(0, 1, 2), help="width: of one column, or of both")
    parser.add_argument("--font", default="", help="latex, or latex:PACKAGE")
    parser.add_argument("--built-in", default="", help="names of the program's methods; others are shown first")
    parser.add_argument("--force", action="store_true", help="replace figures")
    options = parser.parse_args(arguments)
    if not re.fullmatch(r"(latex(:[A-Za-z0-9-]{1,60})?)?", options.font):
        raise Failure(f"--font {options.font[:80]}: give latex, or latex:PACKAGE such as latex:libertine", USAGE)
    for program in ("latex", "dvipng") if options.font else ():
        if not shutil.which(program):
            raise Failure(f"--font {options.font}: no program {program}: apt-get install texlive-latex-extra cm-super dvipng",
                          USAGE)
    return options


def make_figures(options):
    chosen = FigureSet(options)
    try:
        return chosen.write()
    except RuntimeError as error:  # of LaTeX, as matplotlib runs it
        if not options.font:
            raise
        line = next((line for line in str(error).splitlines() if line.startswith("!")), "LaTeX failed")
        raise Failure(f"--font {options.font}: {line[:120]}: give methods and recordings plain labels, or leave --font out",
                      USAGE) from error

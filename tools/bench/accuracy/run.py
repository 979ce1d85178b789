"""Measures rounding errors and writes docs/results/accuracy/rounding.csv: tools/dev.sh bench accuracy [LOG2-OF-THE-LONGEST-SUM] [--print]."""
import subprocess

from tools.bench.speed_page import ROOT, parser_of

TABLE = ROOT / "docs" / "results" / "accuracy" / "rounding.csv"


def main():
    parser = parser_of(__doc__, TABLE.relative_to(ROOT))
    parser.add_argument("longest", type=int, nargs="?", default=26, choices=range(1, 37), metavar="LOG2", help="log2 of the longest sum")
    options = parser.parse_args()
    program = options.build / "tools" / "bench" / "accuracy" / "bench_accuracy"
    table = subprocess.run([program, str(options.longest)], check=True, capture_output=True, text=True).stdout
    if not options.print:
        TABLE.write_text(table, encoding="utf-8")
    print(table, end="")


if __name__ == "__main__":
    main()

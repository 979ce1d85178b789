"""Measures rounding errors and writes docs/results/accuracy/rounding.csv: tools/dev.sh bench accuracy [LOG2-OF-THE-LONGEST-SUM]."""
import subprocess
import sys
from pathlib import Path

TABLE = Path(__file__).resolve().parents[3] / "docs" / "results" / "accuracy" / "rounding.csv"


def main():
    program = Path(sys.argv[1]) / "tools" / "bench" / "accuracy" / "bench_accuracy"
    table = subprocess.run([program, *sys.argv[2:]], check=True, capture_output=True, text=True).stdout
    TABLE.write_text(table, encoding="utf-8")
    print(table, end="")


if __name__ == "__main__":
    main()

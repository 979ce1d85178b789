"""Measures rounding errors and writes them into docs/accuracy.md: tools/dev.sh bench accuracy [LOG2-OF-THE-LONGEST-SUM]."""
import subprocess
import sys
from pathlib import Path

from tools.bench.speed_page import replace_section

PAGE = Path(__file__).resolve().parents[3] / "docs" / "accuracy.md"

def main():
    program = Path(sys.argv[1]) / "tools" / "bench" / "accuracy" / "bench_accuracy"
    table = subprocess.run([program, *sys.argv[2:]], check=True, capture_output=True, text=True).stdout
    replace_section("rounding", table, PAGE)
    print(table, end="")


if __name__ == "__main__":
    main()

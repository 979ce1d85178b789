"""Measures rounding errors and writes docs/accuracy.md: tools/dev.sh bench accuracy [LOG2-OF-THE-LONGEST-SUM]."""
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).resolve().parents[3] / "docs" / "accuracy.md"
TEXT = """# Accuracy

Largest errors of the library against the same computation in `long double` (64 bits of mantissa, 2^11 times finer
than double), over the domains stated. One ulp is 2^-52 of the quantity named (2^-23 where it says float). Written by
`tools/dev.sh bench accuracy`; the sources are `tools/bench/accuracy`.

What the table says: a mean of 1e6 with a deviation of 1e-2 costs the variance eight of its sixteen digits and leaves
eight, as the condition mean / sigma = 1e8 demands, where sums of squares would leave none (of two samples that are
nearly equal, fewer). A mean of 65536 samples taken one by one has lost less than two digits. Sums over 2^26 terms are
as good as those over ten. In the pyramid and the bank a firefly's rounding stays below an ulp of the firefly. Rounding
changes no filter size in the domains tried unless a row says so.

"""


def main():
    program = Path(sys.argv[1]) / "tools" / "bench" / "accuracy" / "bench_accuracy"
    table = subprocess.run([program, *sys.argv[2:]], check=True, capture_output=True, text=True).stdout
    PAGE.write_text(TEXT + table, encoding="utf-8")
    print(table, end="")


if __name__ == "__main__":
    main()

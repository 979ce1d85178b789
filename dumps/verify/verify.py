#!/usr/bin/env python3
"""Test that the samples of a .spool recording are what its header claims.

    python3 dumps/verify/verify.py scene.spool             print the findings
    python3 dumps/verify/verify.py scene.spool --write     and keep them in the recording's metadata

Exit codes: 0 no claim fails, 1 a claim fails or the file is no recording, 2 wrong use, 3 the system refused, 4 damage.
"""
import json
import os
import sys
from argparse import RawDescriptionHelpFormatter
from types import SimpleNamespace

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..")))
sys.path.insert(1, os.path.join(sys.path[0], "formats", "python"))

from dumps.recording.command_line import Parser
from dumps.recording.failure import Failure, module_failure, one_line, usage_failure
from dumps.recording.progress import Progress

try:
    import numpy as np

    import spool
    from dumps.verify.features import feature_findings, picture_findings, radiance_findings
    from dumps.verify.film import film_findings
    from dumps.verify.finding import line, summary
    from dumps.verify.independence import independence_findings, neighbour_finding, repetition_finding
    from dumps.verify.reference_agreement import reference_findings
    from dumps.verify.shared_numbers import shared_number_findings
except ImportError as error:
    if __name__ != "__main__":
        raise
    failure = module_failure(error, "reads a recording", "dumps/verify/verify.py")
    print("verify: %s" % failure, file=sys.stderr)
    sys.exit(failure.code)     # Python's own exit code of a failed import means here that a claim fails

SIGNIFICANCE = 1e-3  # of the whole set of tests, divided among them (Bonferroni)
TESTS = 20
LARGEST_WINDOW = 1 << 26  # values of radiance looked at together


def verify(path):
    """Findings of one recording. Large recordings are judged on a centred window that fits in memory."""
    level = SIGNIFICANCE / TESTS
    with spool.open(path) as dump:
        side_x, side_y = dump.width, dump.height
        while side_x * side_y * dump.spp * 3 > LARGEST_WINDOW and max(side_x, side_y) > 16:
            side_x, side_y = max(16, side_x // 2), max(16, side_y // 2)
        x0, y0 = (dump.width - side_x) // 2, (dump.height - side_y) // 2
        radiance = dump.read("radiance", x0, y0, x0 + side_x, y0 + side_y)
        finite = np.where(np.isfinite(radiance), radiance, 0)
        film = dump.layers.get("film")
        # Of pixel layers the same part.
        part = SimpleNamespace(layers=dump.layers, meta=dump.meta, sample_order=dump.sample_order,
                               pixel=lambda layer: dump.pixel(layer)[y0:y0 + side_y, x0:x0 + side_x])
        tests = (lambda: radiance_findings(radiance) + [repetition_finding(finite, dump.sample_order == "exchangeable")],
                 lambda: independence_findings(finite, dump.sample_order == "exchangeable", level),
                 lambda: [neighbour_finding(finite, film is not None and film.scope == "pass", level)],
                 lambda: film_findings(dump, (x0, y0, x0 + side_x, y0 + side_y), level),
                 lambda: reference_findings(part, finite, level),
                 lambda: shared_number_findings(dump.meta) + feature_findings(dump) + picture_findings(finite))
        found = []
        progress = Progress("verification", len(tests))
        for test in tests:
            found += test()
            progress.step()
        progress.close()
        return {"findings": found, "window": [x0, y0, x0 + side_x, y0 + side_y], "significance": SIGNIFICANCE,
                "holds": all(entry["holds"] is not False for entry in found)}


def keep_verification(path, verification, out=None, force=False):
    """Adds the findings to the recording, in place of earlier ones, and gives it the name `out`; no block is copied."""
    if out and os.path.lexists(out) and not force:
        raise usage_failure("%s: exists: choose another name or give --force" % out)
    spool.append_meta(path, {"verification": verification})
    if out:
        os.replace(path, out)


def main():
    """Python's own exit code of an error means here that a claim fails, so no error may leave as one."""
    try:
        return run()
    except Exception as error:
        print(one_line("verify: %s: the samples could not be tested: %s%s" % (
            sys.argv[1] if sys.argv[1:] else "no file", type(error).__name__, ": %s" % error if str(error) else "")), file=sys.stderr)
        return 3


def run():
    parser = Parser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("dump", metavar="recording")
    parser.add_argument("--write", action="store_true", help="keep the findings in the recording's metadata")
    parser.add_argument("--move-to", metavar="FILE", help="keep them in the recording, and give it this name")
    parser.add_argument("--force", action="store_true", help="replace the file of that name")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quiet", action="store_true", help="print only what fails or is remarkable")
    try:
        options = parser.parse_args()
        verification = verify(options.dump)
        if options.write or options.move_to:
            keep_verification(options.dump, verification, options.move_to, options.force)
    except Failure as failure:
        print("verify: %s" % failure, file=sys.stderr)
        return failure.code
    except spool.SpoolError as error:
        print(error, file=sys.stderr)
        return error.code
    except OSError as error:
        print(one_line("%s: %s" % (options.dump, error.strerror)), file=sys.stderr)
        return 3
    if options.json:
        print(json.dumps(verification, indent=1))
    else:
        for entry in verification["findings"]:
            if entry["holds"] is False or entry["name"] == "picture" or not options.quiet:
                print(line(entry))
        print("%s: %s" % (options.move_to or options.dump, summary(verification["findings"])))
    return 0 if verification["holds"] else 1


if __name__ == "__main__":
    sys.exit(main())

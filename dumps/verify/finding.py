"""One statement about a recording: what was measured, what was expected, and whether they agree."""
from math import isfinite


def finding(name, holds, measured, expected, p_value=None, note=""):
    """holds: True, False, or None where the recording does not contain enough to decide. A p-value that is no number, which metadata
    could not hold, is none: the claim is not known to hold, so it fails unless it was undecided anyway."""
    if p_value is not None and not isfinite(p_value):
        holds, p_value = None if holds is None else False, None
        note = "%sits test gives no number: values are not finite or too large" % (note and note + "; ")
    entry = {"name": name, "holds": holds, "measured": measured, "expected": expected}
    if p_value is not None:
        entry["p_value"] = p_value
    if note:
        entry["note"] = note
    return entry


def summary(findings):
    """What was verified, in one line."""
    holds = [entry["holds"] for entry in findings]
    return "%d claims on the samples hold, %d fail, %d not known" % (holds.count(True), holds.count(False), holds.count(None))


def line(entry):
    verdict = {True: "holds", False: "FAILS", None: "not known"}[entry["holds"]]
    tail = "" if "p_value" not in entry else "  p = %.3g" % entry["p_value"]
    note = "  (%s)" % entry["note"] if entry.get("note") else ""
    return "%-24s %-9s %s, expected %s%s%s" % (entry["name"], verdict, entry["measured"], entry["expected"], tail, note)

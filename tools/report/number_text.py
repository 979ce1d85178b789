"""Figures as people read them: as many digits as the interval supports, lists with 'and'."""

import math

from tools.report.failure import Failure

MOST_DIGITS = 6  # of a ratio


def number_text(value, digits=4):
    """Never anything but a number: figures go into the page as they come from here."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise Failure(f"statistics.json: {str(value)[:40]!r} stands where a number belongs: "
                      "delete it or run spool evaluate again")
    if math.isnan(value):
        return "not known"
    return f"{value:.{digits}g}"


def interval_text(interval, digits=4):
    """"0.0260 [0.0240, 0.0281]" """
    if math.isnan(interval.low) or math.isnan(interval.high):
        return number_text(interval.mean, digits)
    return (f"{number_text(interval.mean, digits)} [{number_text(interval.low, digits)}, "
            f"{number_text(interval.high, digits)}]")


def known_text(interval):
    """To three digits; empty where the mean is not known."""
    return "" if math.isnan(interval.mean) else interval_text(interval, 3)


def digits_of_ratio(value, digits, text=number_text):
    """So many, or more where a ratio that is not 1 would read 1: it would not agree with the verdict beside it."""
    return next((more for more in range(digits, MOST_DIGITS) if value == 1 or float(text(value, more)) != 1), MOST_DIGITS)


def ratio_text(interval):
    """To three digits, or as many as it takes; empty where it is not known."""
    if math.isnan(interval.mean):
        return ""
    mean, *ends = [number_text(value, 3 if math.isnan(value) else digits_of_ratio(value, 3)) for value in interval]
    return mean if math.isnan(interval.low) or math.isnan(interval.high) else f"{mean} [{ends[0]}, {ends[1]}]"


def in_digits(value, digits):
    """What JSON holds, with so many significant digits of every number that is not whole."""
    if isinstance(value, dict):
        return {key: in_digits(item, digits) for key, item in value.items()}
    if isinstance(value, list):
        return [in_digits(item, digits) for item in value]
    return float(f"{value:.{digits}g}") if isinstance(value, float) else value


def count_text(count, noun):
    return f"{count} {noun}{'' if count == 1 else 's'}"


def rounded_count(count):
    """Two digits of it, as a whole number: 380, not 3.8e+02."""
    return f"{float(number_text(count, 2)):.0f}"


def samples_text(spp):
    return f"{spp:g} sample{'' if spp == 1 else 's'} per pixel"


def percent_text(share):
    """Two digits of it: 100 %, not 1e+02 %."""
    return f"{float(number_text(100 * share, 2)):g} %"


def list_text(items, longest):
    """"a, b and c"; beyond `longest`, "a, b and 5 more"."""
    if len(items) > longest:
        items = items[:longest - 1] + [f"{len(items) - longest + 1} more"]
    if len(items) < 2:
        return "".join(items)
    return ", ".join(items[:-1]) + " and " + items[-1]

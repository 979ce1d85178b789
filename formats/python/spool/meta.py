"""The JSON of `meta` records, as strict as section 4.4: one object, finite numbers, whole characters, 64 levels."""
import json
import math
import re

from . import record_layout as layout
from .error import SpoolError


def decode(payload):
    """Payload -> dict; SpoolError without a file name when a rule is broken."""
    if not layout.MIN_META_BYTES <= len(payload) <= layout.MAX_META_BYTES:
        raise SpoolError("damaged", f"meta of {len(payload)} bytes, not 2 bytes to 1 MiB")
    try:
        text = payload.decode("utf-8")
        if text[0] != "{":
            raise ValueError("the first byte is not '{'")
        _check_depth(text)
        value = json.loads(text, parse_constant=_refuse, parse_float=_finite, parse_int=_integer,
                           object_pairs_hook=_whole_characters)
    except (ValueError, OverflowError, RecursionError) as reason:
        raise SpoolError("damaged", f"meta is not one JSON object in UTF-8, {reason}") from None
    return value


def encode(meta):
    """dict (or the text of one) -> payload; text is kept byte for byte."""
    if not isinstance(meta, str):
        try:
            meta = json.dumps(meta, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        except (TypeError, ValueError, RecursionError) as reason:
            raise SpoolError("usage", f"meta cannot be written as JSON, {reason}") from None
    try:
        payload = meta.encode("utf-8")
        decode(payload)
    except (SpoolError, UnicodeEncodeError) as reason:
        raise SpoolError("usage", str(reason)) from None
    return payload


def _refuse(constant):
    raise ValueError(f"{constant} is not JSON")


def _finite(text):
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text[:40]} is outside the range of a double")
    return value


def _integer(text):
    _finite(text)
    return int(text)


# Both rules hold for what the text says, also where a second key of one name hides the first one's value.

def _check_depth(text):
    depth = 0
    for bracket in re.findall(r"[\[\]{}]", re.sub(r'"[^"\\]*(?:\\.[^"\\]*)*"?', "", text, flags=re.DOTALL)):
        depth += 1 if bracket in "[{" else -1
        if depth > layout.MAX_META_DEPTH:
            raise ValueError(f"nested deeper than {layout.MAX_META_DEPTH}")


def _whole_characters(pairs):
    pending = [part for pair in pairs for part in pair]
    while pending:
        value = pending.pop()
        if isinstance(value, str):
            value.encode("utf-8")  # a lone surrogate raises UnicodeEncodeError, a ValueError
        elif isinstance(value, list):  # an object in it has been here
            pending += value
    return dict(pairs)

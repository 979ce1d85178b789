"""The JSON of `meta` records, as strict as section 4.4: one object, finite numbers, whole characters, 64 levels."""
import json
import math

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
        value = json.loads(text, parse_constant=_refuse, parse_float=_finite, parse_int=_integer)
        _walk(value)
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


def _walk(value):
    pending = [(value, 1)]
    while pending:
        value, depth = pending.pop()
        if isinstance(value, str):
            value.encode("utf-8")  # a lone surrogate raises UnicodeEncodeError, a ValueError
        elif isinstance(value, (dict, list)):
            if depth > layout.MAX_META_DEPTH:
                raise ValueError(f"nested deeper than {layout.MAX_META_DEPTH}")
            if isinstance(value, dict):
                pending += [(key, depth + 1) for key in value]
                value = value.values()
            pending += [(item, depth + 1) for item in value]

"""How results name their files, as tools/batch/evaluation_pictures.cpp does."""

import os
import re
import zlib

LONGEST_PART, LONGEST_STEM = 100, 200  # bytes; a file name may have 255, with its ending


def file_name_of(label):
    """Of a recording, method or group of any name: byte by byte."""
    name = re.sub(rb"[^A-Za-z0-9.\-]", b"_", label.encode("utf-8", "replace")).decode()
    return bounded(name.rstrip("_"), LONGEST_PART)


def bounded(name, most):
    """A longer name is cut, and a checksum of the whole is added."""
    return name if len(name) <= most else f"{name[:most - 9]}-{zlib.crc32(name.encode()):08x}"


def dump_names(dumps):
    """{recording: name of its files}: stems, numbered where two are alike."""
    return numbered({dump: file_name_of(os.path.splitext(os.path.basename(dump))[0]) for dump in dumps})


def numbered(stems):
    """{key: stem}, with -2, -3 where two are alike."""
    names = {}
    for key, stem in stems.items():
        name, i = stem, 2
        while name in names.values():
            name, i = f"{stem}-{i}", i + 1
        names[key] = name
    return names

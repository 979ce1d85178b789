#!/usr/bin/env python3
"""SHA-256 of what a recording holds: samples, features and reference, not identifier, metadata or compression.

    python3 dumps/verify/content_hash.py FILE.spool...

Two recordings with one hash hold the same bits, however and whenever they were written, in blocks of one size.
"""
import hashlib
import os
import sys

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..")))
sys.path.insert(1, os.path.join(sys.path[0], "formats", "python"))

import spool
from dumps.recording.failure import guarded


def content_hash(path):
    total = hashlib.sha256()
    with spool.open(path) as dump:
        total.update(repr((dump.width, dump.height, dump.spp, dump.tile_size, dump.block_spp, dump.sample_order,
                           [(c.name, c.group, c.dtype.str, c.scope) for c in dump.channels])).encode())
        for group, tile, begin in sorted(dump.blocks()):
            total.update(repr((group, tile, begin)).encode())
            total.update(dump.block(group, tile, begin).tobytes())
    return total.hexdigest()


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return 0 if len(sys.argv) > 1 else 2
    for path in sys.argv[1:]:
        print("%s  %s" % (content_hash(path), path))
    return 0


if __name__ == "__main__":
    sys.exit(guarded(main))

#!/usr/bin/env python3
"""Rewrites recordings in place so that they are small: one block for all samples of a tile, packed with patience.

    python3 dumps/tiny/squeeze.py dumps/tiny/*.spool

Samples, metadata and uuid stay the same; the bytes of the file do not.
"""
import os
import sys

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..")))
sys.path.insert(1, os.path.join(sys.path[0], "formats", "python"))

from dumps.recording.rewritten import rewrite

for name in sys.argv[1:]:
    print("%s %d bytes" % (name, rewrite(name, name + ".squeezed", block_spp=0)))
    os.replace(name + ".squeezed", name)

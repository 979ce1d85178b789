#!/usr/bin/env python3
"""Rewrites recordings in place so that they are small: one block for all samples of a tile, packed with patience.

    python3 dumps/tiny/squeeze.py dumps/tiny/*.spool

Samples, metadata and uuid stay the same; the bytes of the file do not.
"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
for folder in (("recording",), ("..", "formats", "python")):
    sys.path.insert(0, os.path.join(HERE, "..", *folder))

from rewritten import rewrite  # noqa: E402

for name in sys.argv[1:]:
    print("%s %d bytes" % (name, rewrite(name, name + ".squeezed", block_spp=0)))
    os.replace(name + ".squeezed", name)

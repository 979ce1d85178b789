import os
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
for folder in ("dumps/verify", "dumps/recording", "formats/python"):
    sys.path.insert(0, os.path.join(ROOT, folder))

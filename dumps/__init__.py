"""Recorders of samples, and what tests a recording."""
import sys

sys.dont_write_bytecode = True  # the folder may be that of an installed add-on

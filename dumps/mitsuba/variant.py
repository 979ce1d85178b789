"""Which Mitsuba variant can run here.

The wavefront variants need LLVM, and LLVM 15 and 16 abort the process in every path tracer, so the
choice is tried in a child process before this one depends on it.
"""
import glob
import os
import re
import subprocess
import sys

WAVEFRONT, FALLBACK = "llvm_ad_rgb", "scalar_rgb"
PROBE = """
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
import numpy as np
scene = mi.load_dict({"type": "scene", "integrator": {"type": "path"}, "sensor": {"type": "perspective",
    "film": {"type": "hdrfilm", "width": 4, "height": 4}}, "light": {"type": "constant"}, "ball": {"type": "sphere"}})
assert np.isfinite(np.array(mi.render(scene, spp=1))).all()
"""


def force_good_llvm():
    """Points Dr.Jit to LLVM 19 or newer where one is installed and the user has not chosen."""
    if "DRJIT_LIBLLVM_PATH" in os.environ:
        return
    found = []
    for pattern in ("/usr/lib/*/libLLVM.so.*", "/usr/lib/*/libLLVM-*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*"):
        for path in glob.glob(pattern):
            version = re.search(r"libLLVM[-.](?:so\.)?(\d+)", os.path.basename(path))
            if version and int(version.group(1)) >= 19:
                found.append((int(version.group(1)), path))
    if found:
        os.environ["DRJIT_LIBLLVM_PATH"] = max(found)[1]


def choose_variant(wanted=None):
    """The variant to use and, when it is not the fast one, why."""
    if wanted:
        return wanted, None
    force_good_llvm()
    probe = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, text=True)
    if probe.returncode == 0:
        return WAVEFRONT, None
    last = (probe.stderr.strip().splitlines() or ["exit code %d" % probe.returncode])[-1]
    return FALLBACK, "no usable LLVM (%s): install libllvm19 for recordings 24 times faster" % last

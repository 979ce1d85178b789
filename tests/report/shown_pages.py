"""Pages of spool show by the program, and cells of a notebook by the package in its own Python."""

import json
import os
import subprocess

import numpy as np

from tools.report.exr_image import exr

PACKAGE = os.environ.get("SPOOL_PACKAGE")  # none in a build with sanitizers


def write_exr(path, image):
    exr.write(path, dict(zip("RGB", np.moveaxis(np.asarray(image, np.float32), 2, 0))), force=True)
    return path


def shown(folder, images, *words):
    """The page of {name: image}."""
    files = [f"{name}={write_exr(folder / f'{i}.exr', image)}" for i, (name, image) in enumerate(images.items())]
    page = folder / "page.html"
    subprocess.run([os.environ["SPOOL_PROGRAM"], "show", *files, *map(str, words), "--force", "-q", "-o", page], check=True, timeout=120)
    return page


def cells(code, folder):
    """The HTML of the objects that `code` puts into the list `shown`."""
    script = f"import json, numpy as np, spool\nshown = []\n{code}\nprint(json.dumps([x._repr_html_() for x in shown]))"
    done = subprocess.run([os.environ["SPOOL_PYTHON"], "-c", script], cwd=folder, check=True, capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": PACKAGE}, timeout=300)
    return json.loads(done.stdout)

"""The pictures of docs/method.md are what the program makes today."""
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

ROOT = Path(__file__).resolve().parents[2]
COMMITTED = ROOT / "docs/images/method"


def test_committed_pictures_are_made_again(tmp_path):
    subprocess.run([sys.executable, "-m", "tools.study.method_pictures", "--program",
                    os.environ["SPOOL_PROGRAM"], "--output", tmp_path], check=True)
    made = sorted(path.name for path in tmp_path.glob("*.png"))
    assert made == sorted(path.name for path in COMMITTED.glob("*.png"))
    for name in made:
        now, then = (oiio.ImageBuf(str(folder / name)).get_pixels(oiio.UINT8) for folder in (tmp_path, COMMITTED))
        assert np.array_equal(now, then), f"{name}: run tools/study/method_pictures.py and look at what changed"


def test_the_page_shows_every_picture():
    page = (ROOT / "docs/method.md").read_text(encoding="utf-8")
    for path in COMMITTED.glob("*.png"):
        assert f"images/method/{path.name}" in page

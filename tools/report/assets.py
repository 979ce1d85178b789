"""The two scripts of other people that a report carries, taken from a cache and checked by sha256.

They are fetched by fetch_assets.sh and never stored in the repository; assets.sha256 pins them.
"""

import hashlib
import os
from pathlib import Path
from typing import NamedTuple

from tools.report.failure import Failure

HERE = Path(__file__).resolve().parent
FETCH = "run tools/report/fetch_assets.sh once (needs the network)"


class Asset(NamedTuple):
    name: str
    source: str
    script: str  # file
    licence: str  # file


ASSETS = (
    Asset("plotly.js basic 4.1.1", "npm plotly.js-basic-dist-min", "plotly-basic.min.js",
          "plotly-LICENSE.txt"),
    Asset("tablesort 5.6.0", "npm tablesort", "tablesort.min.js", "tablesort-LICENSE.txt"),
)


def cache_folder():
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get("SPOOL_REPORT_ASSETS") or Path(cache) / "spool" / "report-assets")


def pinned_hashes():
    """{file: sha256}"""
    lines = (HERE / "assets.sha256").read_text(encoding="ascii").splitlines()
    return {name.strip(): digest for digest, name in (line.split(None, 1) for line in lines if line)}


def load_asset(file):
    path = cache_folder() / file
    if not path.exists() and (HERE / "assets" / file).exists():
        path = HERE / "assets" / file  # beside an installed program
    try:
        data = path.read_bytes()
    except OSError as error:
        what = "not there" if isinstance(error, FileNotFoundError) else error.strerror
        raise Failure(f"{path}: {what}: {FETCH}", 3) from error
    if hashlib.sha256(data).hexdigest() != pinned_hashes()[file]:
        raise Failure(f"{path}: not the file that was pinned (sha256 differs): delete it and {FETCH}", 3)
    return data.decode("utf-8")

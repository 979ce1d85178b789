"""Puts the one script that a page would fetch from the network into the site: search_offline.py SITE SCRIPT"""

import os
import shutil
import sys
from pathlib import Path

FETCHED = "https://unpkg.com/iframe-worker/shim"


def main():
    site, script = map(Path, sys.argv[1:])
    kept = site / "assets/javascripts/iframe-worker.js"
    shutil.copyfile(script, kept)
    pages = [page for page in site.rglob("*.html") if FETCHED in page.read_text(encoding="utf-8", errors="replace")]
    for page in pages:
        text = page.read_text(encoding="utf-8", errors="replace")
        page.write_text(text.replace(FETCHED, os.path.relpath(kept, page.parent)), encoding="utf-8")
    if not pages:
        sys.exit(f"{site}: no page asks for {FETCHED}: look at what it asks for now")


if __name__ == "__main__":
    main()

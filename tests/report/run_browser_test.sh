#!/usr/bin/env bash
# Runs test_browser*.py where Chromium, playwright and the report's assets are; else says so, loudly, and ends with 77.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
cache="${XDG_CACHE_HOME:-$HOME/.cache}/spool"
python="${SPOOL_BROWSER_PYTHON:-$cache/browser-venv/bin/python}"
assets="${SPOOL_REPORT_ASSETS:-$cache/report-assets}"
pinned="$(cd ../../tools/report && pwd)/assets.sha256"

skip() {
  printf '\n#### SKIPPED: the browser test of the report did not run: %s\n#### tools/dev.sh setup test installs what it needs.\n\n' "$*" >&2
  exit 77
}
command -v "${SPOOL_CHROMIUM:-chromium}" >/dev/null || skip "no chromium"
"$python" -c 'import playwright, numpy, pytest' 2>/dev/null || skip "no playwright in $python"
(cd "$assets" 2>/dev/null && sha256sum --status --check "$pinned") || skip "no report assets in $assets"
PYTHONPATH="$(cd ../.. && pwd):$(cd ../../formats/python && pwd)" exec "$python" -m pytest -q -p no:cacheprovider test_browser*.py

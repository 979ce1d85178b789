#!/usr/bin/env bash
# Runs the tests of the Mitsuba recorder with a Python that has Mitsuba; else says so, loudly, and ends with 77.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
python="${SPOOL_MITSUBA_PYTHON:-${XDG_CACHE_HOME:-$HOME/.cache}/spool/mitsuba-venv/bin/python}"
"$python" -c 'import mitsuba, numpy, pytest' 2>/dev/null || {
  printf '\n#### SKIPPED: the Mitsuba recorder was not tested: no mitsuba in %s\n#### tools/dev.sh setup test installs it.\n\n' "$python" >&2
  exit 77
}
exec "$python" -m pytest -q -p no:cacheprovider

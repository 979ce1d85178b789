#!/usr/bin/env bash
# Fetches the scripts that a report carries into the cache, checked by sha256 (assets.sha256).
# usage: tools/report/fetch_assets.sh [--complete] [FOLDER]   --complete: fetches nothing, says by its exit code whether all is there
#   default: $SPOOL_REPORT_ASSETS, else the user's cache
set -euo pipefail
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
only_ask=""
[[ "${1:-}" == --complete ]] && { only_ask=1; shift; }
folder="${1:-${SPOOL_REPORT_ASSETS:-${XDG_CACHE_HOME:-$HOME/.cache}/spool/report-assets}}"

complete() { (cd "$1" 2>/dev/null && sha256sum --status --check "$here/assets.sha256" 2>/dev/null); }
die() { printf 'fetch_assets.sh: %s\n' "$*" >&2; exit 3; }

# By the registry's own client; npm is Debian's package of that name.
fetch_npm() {  # PACKAGE VERSION
  command -v npm >/dev/null || die "npm is missing: apt-get install --no-install-recommends npm"
  echo "report assets: npm pack $1@$2" >&2
  npm pack --silent "$1@$2" >/dev/null || die "$1 $2 cannot be fetched by npm"
}

if [[ -n "$only_ask" ]]; then complete "$folder"; exit; fi
if complete "$folder"; then
  echo "report assets: complete in $folder"
  exit 0
fi
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
fetch_npm plotly.js-basic-dist-min 4.1.1
fetch_npm tablesort 5.6.0
mkdir assets
tar -xzOf plotly.js-basic-dist-min-4.1.1.tgz package/plotly-basic.min.js >assets/plotly-basic.min.js
tar -xzOf plotly.js-basic-dist-min-4.1.1.tgz package/LICENSE >assets/plotly-LICENSE.txt
tar -xzOf tablesort-5.6.0.tgz package/dist/tablesort.min.js >assets/tablesort.min.js
tar -xzOf tablesort-5.6.0.tgz package/LICENCE >assets/tablesort-LICENSE.txt
complete assets || {
  (cd assets && sha256sum --check --quiet "$here/assets.sha256" >&2) || true
  die "what was fetched is not what was pinned: nothing is kept"
}
mkdir -p "$folder"
cp assets/* "$folder"
echo "report assets: $folder"

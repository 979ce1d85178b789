#!/usr/bin/env bash
# Installs the packages in a fresh Debian 12, uses them as a stranger would, removes them, and looks for what is left.
# usage: tools/package/clean_root.sh FOLDER-OF-PACKAGES   (as root; needs mmdebstrap and the network)
set -euo pipefail
here="$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")"
packages="$(cd "${1:?a folder of .deb files}" && pwd)"
say() { printf '== %s\n' "$*" >&2; }
die() { printf 'clean_root.sh: %s\n' "$*" >&2; exit 1; }

command -v mmdebstrap >/dev/null || die "apt-get install mmdebstrap"
root="$(mktemp -d)"
finish() {
  # What is mounted goes first: rm must not reach the machine's own files.
  mountpoint -q "$root/proc" && umount "$root/proc"
  rm -rf --one-file-system "$root"
}
trap finish EXIT

# What the packages depend on comes with the root and stays; versions and alternatives are apt's to check below.
needed="$(for package in "$packages"/*.deb; do dpkg-deb --field "$package" Depends; echo; done |
  tr ',' '\n' | sed 's/(.*//; s/|.*//; s/ //g' | grep -vxE '|spool|spool-png' | sort -u | paste -sd,)"
say "a fresh Debian 12 in $root, with $needed"
mmdebstrap --quiet --variant=apt --include="$needed,g++,cmake,ninja-build" bookworm "$root"
mount -t proc proc "$root/proc"
inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive chroot "$root" "$@"; }
files() { inside find / -xdev \( -path /proc -o -path /var/cache -o -path /var/lib/apt -o -path /var/lib/dpkg -o -path /var/log -o -path /tmp \) -prune -o -print | sort; }

mkdir -p "$root/tmp/packages"
cp "$packages"/*.deb "$root/tmp/packages"
files >"$root/tmp/before"

say "apt-get install ./*.deb"
inside sh -c 'apt-get install -qq -y --no-install-recommends /tmp/packages/*.deb' >/dev/null

say "program, report, picture"
cp "$here/dumps/tiny/chess.spool" "$root/tmp"
cp -r "$here/docs/examples" "$root/tmp/examples"
# shellcheck disable=SC2016  # the inner shell expands
inside bash -ec '
  cd /tmp
  spool --version
  spool check -q chess.spool
  time spool evaluate chess.spool --samplers uniform,multiscale --filters box,directional --spp 8 -q -o results
  time spool report results -o report.html
  spool replay chess.spool --sampler multiscale --spp 8 -o selection.exr
  spool reconstruct chess.spool --selection selection.exr --filter directional -o program.exr
  spool reconstruct chess.spool --filter box -o box.png
  test "$(head -c 4 box.png | tail -c 3)" = PNG
  python3 -c "import spool; print(spool.open(\"chess.spool\").read(\"radiance\").shape)"'

say "the C++ program against the installed package"
inside bash -ec '
  cd /tmp
  cmake -G Ninja -S examples -B build -DCMAKE_BUILD_TYPE=Release >/dev/null
  cmake --build build >/dev/null
  build/replay_and_reconstruct chess.spool own.exr
  spool metrics own.exr program.exr | grep -E "^mse "'

say "removing"
inside apt-get purge -qq -y spool spool-png libspool-dev python3-spool >/dev/null
files >"$root/tmp/after"
diff "$root/tmp/before" "$root/tmp/after" >&2 || die "the lines above are left of the packages, or were taken with them"
inside sh -c '! dpkg-query -l "*spool*" 2>/dev/null | grep -E "^[^u+|D]"' || die "dpkg still knows them"
say "nothing is left"

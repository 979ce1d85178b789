#!/bin/sh
# Records a scene with Blender's Cycles and packs it into one dump:
#   dumps/record.sh NAME|FILE.blend [--size WxH] [--samples N] [--reference N] [--OPTION VALUE]... -o FILE.spool
# NAME is a script of dumps/scenes. Further options go to dumps/cycles/record.py (--mode, --seed, --channels ...).
# --compress goes to `spool pack`. dumps/verify tests the samples and keeps what it found in the dump (`spool info`
# shows it); --no-verify leaves that out. The passes lie in FILE.spool.passes until the dump is whole and tested, so an
# interrupted run continues; --keep leaves them there. --force replaces a file of that name.
# BLENDER names the Blender to use, or a Python with the module bpy; SPOOL the program.
# Exit codes: 0 done, 1 the scene cannot be recorded or its samples fail verification, 2 wrong use, 3 Blender or the system refused, 4 damage.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
fail() { code=$1; shift; echo "record.sh: $*" >&2; exit "$code"; }
usage() { sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p;}' "$0"; }

[ $# -ge 1 ] || { usage >&2; exit 2; }
case $1 in -h|--help) usage; exit 0 ;; -*) fail 2 "the first argument is a scene or a .blend file, not $1" ;; esac
scene=$1; shift
out=; keep=; pack=; force=; dry=; verify=yes
count=$#
while [ "$count" -gt 0 ]; do
  argument=$1; shift; count=$((count - 1))
  case $argument in
    -o|--out) [ "$count" -gt 0 ] || fail 2 "$argument needs a file"
              out=$1; shift; count=$((count - 1)) ;;
    --keep) keep=yes ;;
    --no-verify) verify= ;;
    --compress) pack=$argument ;;
    --force) force=$argument ;;
    --dry-run) dry=yes; set -- "$@" "$argument" ;;
    *) set -- "$@" "$argument" ;;
  esac
done
[ -n "$out$dry" ] || fail 2 "no file for the dump: give -o FILE.spool"
case $scene in *.blend) set -- --blend "$scene" "$@" ;; *) set -- --scene "$scene" "$@" ;; esac
passes=$out.passes
[ -z "$out" ] || set -- "$@" -o "$passes"

spool=${SPOOL:-}
for candidate in "$here/../build/release/tools/spool" "$here/../build/release/spool"; do
  [ -n "$spool" ] || [ ! -x "$candidate" ] || spool=$candidate
done
[ -n "$spool" ] || spool=$(command -v spool) || [ -n "$dry" ] || fail 3 "the program spool is not built: run cmake, or set SPOOL"
# It packs at the end: said before hours of rendering.
if [ -z "$dry" ] && { ! program=$(command -v "$spool") || [ ! -f "$program" ] || [ ! -x "$program" ]; }; then
  fail 3 "SPOOL=$spool is no program: set it to the built one"
fi
[ -n "$force" ] || [ -z "$out" ] || [ ! -e "$out" ] || fail 2 "$out exists: choose another name or give --force"

blender=${BLENDER:-blender}
program=$(command -v "$blender") || fail 3 "$blender is not installed: apt-get install blender python3-numpy python3-zstandard, or set BLENDER"
record=$here/cycles/record.py
case $(basename "$program") in
  python*) "$program" "$record" "$@" ;;
  # Blender says which version it is, and that it quits; the recorder speaks on standard error and in its last line
  *) "$program" -b --factory-startup -P "$record" --python-exit-code 3 -- "$@" ;;
esac
[ -z "$dry" ] || exit 0
# The dump gets its name when its samples were tested: the passes lie there until then, and the same command goes on.
checker=; code=0
for python in ${verify:+python3 /usr/bin/python3}; do
  if "$python" -c 'import numpy, zstandard' 2>/dev/null; then checker=$python; break; fi
done
if [ -n "$checker" ]; then
  # shellcheck disable=SC2086
  "$spool" pack "$passes" -o "$passes/whole.spool" --force $pack
  # shellcheck disable=SC2086
  "$checker" "$here/verify/verify.py" "$passes/whole.spool" -o "$out" --quiet $force || code=$?
  [ "$code" -le 1 ] || exit "$code"
  [ "$code" = 0 ] || echo "record.sh: $out is whole, but its samples are not what they should be: see above" >&2
else
  # shellcheck disable=SC2086
  "$spool" pack "$passes" -o "$out" $force $pack
  [ -z "$verify" ] ||
    echo "record.sh: $out is not verified: apt-get install python3-numpy python3-zstandard, then dumps/verify/verify.py $out --write" >&2
fi
if [ -n "$keep" ]; then rm -f "$passes/whole.spool"; else rm -rf "$passes"; fi
exit "$code"

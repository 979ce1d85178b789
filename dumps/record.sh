#!/bin/sh
# Records a scene with Blender's Cycles and packs it into one recording:
#   dumps/record.sh NAME|FILE.py|FILE.blend [--size WxH] [--samples N] [--reference N] [--OPTION VALUE]... -o FILE.spool
# NAME is a script of dumps/scenes, FILE.py one with build(find), which returns a scene. Further options go to dumps/cycles/record.py (--mode, --seed, --channels ...).
# --recordings 4 makes four recordings of a quarter of the samples each, FILE_1.spool ..., which share the reference and are judged as a group by
# `spool evaluate FILE_*.spool`. --compress, --full-features and --half-radiance go to `spool pack`. dumps/verify tests the samples and keeps what it found in the recording (`spool info`
# shows it); --no-verify leaves that out. The passes lie in FILE.spool.passes, and each goes when the recording takes it, so that the disk holds no
# sample twice: an interrupted run continues, and one that was killed while it packed renders those again. --keep leaves them there. --force
# replaces a file of that name.
# BLENDER names the Blender to use, or a Python with the module bpy; SPOOL the program.
# Exit codes: 0 done, 1 the scene cannot be recorded or its samples fail verification, 2 wrong use, 3 Blender or the system refused, 4 damage.
set -eu

here=$(dirname "$(readlink -f "$0")")
fail() { code=$1; shift; echo "record.sh: $*" >&2; exit "$code"; }
usage() { sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p;}' "$0"; }

[ $# -ge 1 ] || { usage >&2; exit 2; }
case $1 in
  -h|--help) usage; exit 0 ;;
  -*) fail 2 "the first argument is a scene or a .blend file, not $1 (if that is its name, write ./$1)" ;;
esac
scene=$1; shift
out=; keep=; pack=; force=; dry=; verify=yes; recordings=1
count=$#
while [ "$count" -gt 0 ]; do
  argument=$1; shift; count=$((count - 1))
  case $argument in
    -o|--out) [ "$count" -gt 0 ] || fail 2 "$argument needs a file"
              out=$1; shift; count=$((count - 1)) ;;
    --recordings) [ "$count" -gt 0 ] || fail 2 "$argument needs a number"
                  recordings=$1; set -- "$@" "$argument" ;;
    --keep) keep=yes ;;
    --no-verify) verify= ;;
    --compress|--full-features|--half-radiance) pack="$pack $argument" ;;
    --force) force=$argument ;;
    --dry-run) dry=yes; set -- "$@" "$argument" ;;
    *) set -- "$@" "$argument" ;;
  esac
done
case $out in -*) out=./$out ;; esac
[ -n "$out$dry" ] || fail 2 "no file for the recording: give -o FILE.spool"
case $scene in *.blend) set -- --blend "$scene" "$@" ;; *) set -- --scene "$scene" "$@" ;; esac
passes=$out.passes
[ -z "$out" ] || set -- "$@" -o "$passes"

spool=${SPOOL:-}
for candidate in "$here/../build/release/tools/spool" "$here/../build/release/spool"; do
  [ -n "$spool" ] || [ ! -x "$candidate" ] || spool=$candidate
done
[ -n "$spool" ] || spool=$(command -v spool) || [ -n "$dry" ] || fail 3 "the program spool is not built: tools/dev.sh build, or let SPOOL name it"
# It packs at the end: said before hours of rendering.
if [ -z "$dry" ] && { ! program=$(command -v "$spool") || [ ! -f "$program" ] || [ ! -x "$program" ]; }; then
  fail 3 "SPOOL=$spool is no program: set it to the built one"
fi
case $recordings in ''|*[!0-9]*|0) fail 2 "--recordings $recordings: give a number of recordings" ;; esac
# NAME.spool, or NAME_1.spool ... NAME_N.spool
case $(basename "$out") in ?*.*) stem=${out%.*}; end=.${out##*.} ;; *) stem=$out; end= ;; esac
name_of() { if [ "$recordings" = 1 ]; then echo "$out"; else echo "${stem}_$1$end"; fi; }
folder_of() { if [ "$recordings" = 1 ]; then echo "$passes"; else echo "$passes/recording_$1"; fi; }
# Packed, and stopped before all were tested: the same command goes on from there, another one renders what it lacks and replaces it then.
wish="$recordings $pack $*"
packed=
if [ -e "$passes/packed" ] && [ "$(cat "$passes/packed")" = "$wish" ]; then
  packed=--packed
  for number in $(seq "$recordings"); do
    [ -e "$(folder_of "$number")/whole.spool" ] || { [ -e "$passes/named" ] && [ -e "$(name_of "$number")" ]; } || packed=
  done
fi
# $passes/named: files of this very command have got their names since, and it replaces them.
refuse_existing() {
  for number in $(seq "$recordings"); do
    [ -n "$force" ] || [ -z "$out" ] || [ ! -e "$(name_of "$number")" ] || { [ -n "$packed" ] && [ -e "$passes/named" ]; } ||
      fail 2 "$(name_of "$number") exists: choose another name or give --force"
  done
}
refuse_existing
[ -n "$keep$dry" ] || set -- "$@" --fold
[ -z "$packed" ] || set -- "$@" "$packed"

blender=${BLENDER:-blender}
program=$(command -v "$blender") || fail 3 "$blender is not installed: apt-get install blender python3-numpy python3-zstandard, or set BLENDER"
record=$here/cycles/record.py
case $(basename "$program") in
  python*) "$program" "$record" "$@" ;;
  # Blender says which version it is, and that it quits; the recorder speaks on standard error and in its last line
  *) "$program" -b --factory-startup -P "$record" --python-exit-code 3 -- "$@" ;;
esac
[ -z "$dry" ] || exit 0
# The recorder's own lock, until the files have their names: another command would replace what is packed here.
if command -v flock > /dev/null; then
  exec 9>> "$passes/.lock"
  flock -n 9 || fail 2 "$passes: another recorder is writing here: run the same command again when it has ended"
fi
# A dump gets its name when its samples were tested.
checker=; code=0
for python in ${verify:+python3 /usr/bin/python3}; do
  if "$python" -c 'import numpy, zstandard' 2>/dev/null; then checker=$python; break; fi
done
if [ -z "$packed" ]; then
  # What another command packed here goes only now, when all that replaces it is rendered; its mark first.
  rm -f "$passes/packed" "$passes/named" "$passes/whole.spool" "$passes"/recording_*/whole.spool
  [ "$recordings" = 1 ] || python3 "$here/cycles/split.py" "$passes" "$recordings" "$out"
  remove=--remove-passes; [ -z "$keep" ] || remove=
  printf '%s\n' "$wish" > "$passes/packed"
  for number in $(seq "$recordings"); do
    from=$(folder_of "$number")
    # shellcheck disable=SC2086
    "$spool" pack "$from" -o "$from/whole.spool" --force $pack $remove --max-expansion 1000000
  done
fi
# dump -> tested, under its name
finish() {
  whole=$1; to=$2; result=0
  [ -e "$whole" ] || return 0    # a run that was stopped has named it
  if [ -z "$checker" ]; then
    mv -f "$whole" "$to" || fail 3 "$to was not made: the recording is kept in $whole, the same command goes on from there"
    [ -z "$verify" ] ||
      echo "record.sh: $to is not verified: apt-get install python3-numpy python3-zstandard, then dumps/verify/verify.py $to --write" >&2
    return
  fi
  "$checker" "$here/verify/verify.py" "$whole" --move-to "$to" --quiet --force || result=$?
  case $result in [0-4]) ;; *) result=3 ;; esac    # killed, or a Python that does not start
  # The passes go at the end: only a file that is under its name stands for them, whatever the code says.
  if [ -e "$whole" ] || [ ! -e "$to" ]; then
    [ "$result" -gt 1 ] || result=3
    fail "$result" "$to was not made, the recording is kept in $whole: the same command goes on from there (--no-verify leaves the test out)"
  fi
  [ "$result" -le 1 ] || exit "$result"
  [ "$result" = 0 ] || { code=1; echo "record.sh: $to is whole, but its samples are not what they should be: see above" >&2; }
}
# as a shell takes it
quoted() {
  case $1 in *[!A-Za-z0-9_./-]*) printf "'%s'" "$(printf '%s' "$1" | sed "s/'/'\\\\''/g")" ;; *) printf '%s' "$1" ;; esac
}
refuse_existing
: > "$passes/named"
dumps=
for number in $(seq "$recordings"); do
  to=$(name_of "$number")
  finish "$(folder_of "$number")/whole.spool" "$to"
  dumps="$dumps $(quoted "$to")"
done
[ "$code" != 0 ] || echo "next: spool evaluate$dumps --spp 4,8 --samplers uniform,multiscale --filters box,directional -o results"
if [ -n "$keep" ]; then rm -rf "$passes/named" "$passes/packed" "$passes"/recording_*; else rm -rf "$passes"; fi
exit "$code"

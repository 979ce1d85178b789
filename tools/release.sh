#!/usr/bin/env bash
# Makes the files of a release: source archive, Debian packages, Blender add-on, wheel, checksums. Tags nothing.
# usage: tools/release.sh [--check] [FOLDER]    --check: only whether the tree is ready; FOLDER: default build/release-VERSION
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
die() { printf 'release.sh: %s\n' "$*" >&2; exit 1; }
say() { printf '== %s\n' "$*" >&2; }

only_check=""
[[ "${1:-}" == --check ]] && { only_check=1; shift; }
version="$(sed -n 's/^project(spool VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
[[ -n "$version" ]] || die "CMakeLists.txt: no version in project(spool VERSION ...)"
folder="${1:-build/release-$version}"

[[ -z "$(git rev-parse --show-cdup 2>/dev/null || echo none)" ]] || die "$PWD is no git clone of this user's: a release is made of a commit"
[[ -z "$(git status --porcelain)" ]] || die "the tree has changes or files that git does not know: commit or remove them first"
grep -qx "version: $version" CITATION.cff || die "CITATION.cff: its version is not $version"
section="$(sed -n "/^## $version /,/^## /p" CHANGELOG.md | sed '/^## /d')"
grep -qE "^## $version - [0-9]{4}-[0-9]{2}-[0-9]{2}$" CHANGELOG.md || die "CHANGELOG.md: no section '## $version - YEAR-MONTH-DAY'"
[[ -n "${section//[[:space:]]/}" ]] || die "CHANGELOG.md: the section $version is empty"
! git rev-parse -q --verify "refs/tags/v$version" >/dev/null || die "v$version is tagged already: raise the version"
[[ -z "$only_check" ]] || { echo "ready: $version"; exit 0; }
[[ ! -e "$folder" ]] || die "$folder exists: remove it or name another"

mkdir -p "$folder"
say "source archive"
git archive --format=tar.gz --prefix="spool-$version/" -o "$folder/spool-$version.tar.gz" HEAD
say "Debian packages"
tools/dev.sh package >/dev/null
cp build/release/packages/*.deb "$folder"
say "Blender add-on"
tools/dev.sh addon "$folder/spool_recorder-$version.zip" >/dev/null
say "wheel"
tools/dev.sh wheel
for file in build/wheels/*-"$version"-*.whl; do
  [[ "$file" -nt "$folder/spool-$version.tar.gz" ]] && cp "$file" "$folder"
done
compgen -G "$folder/*.whl" >/dev/null || die "tools/dev.sh wheel made no wheel of version $version"
printf '%s\n' "$section" >"$folder/NOTES.txt"
(cd "$folder" && sha256sum -- *spool* >SHA256SUMS)
git diff --quiet HEAD || die "making the files changed the tree: see git status"

say "files of $version in $folder"
cat "$folder/SHA256SUMS"
cat <<TEXT

To publish:  git tag -a v$version -F $folder/NOTES.txt && git push origin v$version
             python3 -m twine upload $folder/*.whl        (an account of PyPI; the wheel was installed by its name from a folder that has it alone)
TEXT

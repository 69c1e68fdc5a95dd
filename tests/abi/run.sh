#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/abi/run.sh [BUILD]
#
# Tests the promises of docs/abi.md with the libraries and the host that were kept for this version of
# the contract. It runs old libraries in the host of BUILD (default build/release), and new ones in
# the kept host. It also tests a library of a made-up version 1.99, records of a second version, and
# the layout of each struct. The libraries and the host in kept are never rebuilt.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
repository=$(cd "$here/../.." && pwd)
build=$(cd "${1:-$repository/build/release}" && pwd)
version=1.0
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

failures=0
fail() {
  echo "abi: $1" >&2
  failures=$((failures + 1))
}

# answers HOST FOLDER FILE: what the components in a folder answer to a host, in a file.
answers() {
  WEFT_PLUGIN_PATH=$2 "$1" >"$3" 2>"$3.err" || fail "$1 on $2: $(cat "$3.err")"
}

expect_golden() {
  if diff -u "$kept/golden.txt" "$1" >difference; then
    echo "  $2: $(grep -c '^[a-z]*/[^ ]* .*: ' "$1") calls, the same answers"
  else
    fail "$2: other answers than were kept"
    head -20 difference >&2
  fi
}

# expect_kept FOLDER: its files are those of SHA256SUMS, whose first line names a decision.
expect_kept() {
  (cd "$1" && sha256sum --quiet --check SHA256SUMS) || fail "a file in $1 has been changed"
  decision=$(sed -n '1s/^# //p' "$1/SHA256SUMS")
  test -f "$repository/${decision:-none}" || fail "$1/SHA256SUMS names no decision"
}

expect_line() {
  grep -q -- "$2" "$1" || fail "$3: says no '$2', but: $(cat "$1")"
}

kept=$here/kept/$version
expect_kept "$kept"
expect_kept "$here/kept/1.0-rc"
for archive in "$kept"/*.tar.xz "$here/kept/1.0-rc/c.tar.xz"; do tar xJf "$archive"; done
host_now=$build/tests/abi/weft_abi_host
host_kept=$folder/$version/host/weft_abi_host
"$here/needs_only_libc.sh" "$host_kept" || fail "the kept host may not start on a later system"

echo "kept libraries of $version in the host of this build"
for made_by in gcc clang_libcxx; do
  answers "$host_now" "$folder/$version/$made_by" "$made_by.txt"
  expect_golden "$made_by.txt" "made by $made_by"
done

echo "libraries of this build in the kept host of $version"
cmake -S "$here/plugins" -B new -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O0 -Dweft_DIR="$build" \
    -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" \
  ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"} >/dev/null
cmake --build new -j "$(nproc)" >/dev/null || fail "the plugins do not build"
answers "$host_kept" "$folder/new" new.txt
expect_golden new.txt "built now"
answers "$host_now" "$folder/new" both.txt
expect_golden both.txt "built now, in the host of this build"

echo "a library of the release candidate"
WEFT_PLUGIN_PATH=$folder/1.0-rc/c "$host_now" >said 2>&1 &&
  fail "a library of the release candidate is used"
expect_line said 'release candidate of plugin ABI 1.0' "a library of the release candidate"
"$build/bin/weft" plugins describe 1.0-rc/c/filters_keep.so >said 2>&1 &&
  fail "a library of the release candidate is described"
expect_line said 'release candidate of plugin ABI 1.0' "a library of the release candidate"

echo "libraries of a made-up version 1.99"
mkdir later
for kind in NEWER NEEDS VERSION_2 BOTH; do
  library=later/filters_kept_$(echo $kind | tr '[:upper:]' '[:lower:]').so
  cc -std=c99 -D$kind -fPIC -shared -Wl,--build-id=sha1 -I "$repository/framework/include" \
    "$here/newer.c" -o "$library"
  if [ $kind = NEEDS ]; then continue; fi
  "$build/bin/weft" plugins describe "$library" >/dev/null || fail "$library is not described"
done
"$build/bin/weft" plugins describe later/filters_kept_needs.so >said 2>&1 &&
  fail "a library that needs a later host is described"
expect_line said 'needs plugin ABI 1.99' "a library that needs a later host"
# Its manifest is then the later host's.
build_id=$(readelf -n later/filters_kept_needs.so | sed -n 's/ *Build ID: //p')
sed "s/^needs_minor: 0/needs_minor: 99/; s/^build_id: .*/build_id: \"$build_id\"/; s/kept\.newer/kept.needs/" \
  later/filters_kept_newer.plugin.yaml >later/filters_kept_needs.plugin.yaml
cp "$folder"/new/sources* "$folder"/new/templates* "$folder"/new/detectors* \
  "$folder"/new/matchers* later
for host in "$host_now" "$host_kept"; do
  answers "$host" "$folder/later" later.txt
  expect_line later.txt '^filters/kept.newer filter 3: ok' "a newer library that needs nothing new"
  expect_line later.txt 'score f64 .*0\.5 0\.5' "an output that came later is refused"
  expect_line later.txt "refused filters_kept_newer.so: .*filters/kept.unknown_type" \
    "a component with a parameter of a later type"
  expect_line later.txt '^filters/kept.both filter 3: ok' "a library that knows two versions of a record"
  expect_line later.txt "refused filters_kept_newer.so: 'tracks' of 'tracks/kept.later' is no role" \
    "a component of a role that came later"
  expect_line later.txt 'refused filters_kept_needs.so: it needs plugin ABI 1.99' \
    "a library that needs a later host"
  expect_line later.txt "refused filters_kept_version_2.so: 'filters/kept.version2' knows correspondences/2" \
    "a library that knows the second version of a record only"
done

echo "the layout of the structs, the values and the catalogue"
{
  python3 "$here/layout.py" "$repository/framework/include/weft/abi.h"
  "$host_now" --catalogue
} >layout.txt
python3 "$here/layout.py" --compare "$kept/layout.txt" layout.txt >difference ||
  { cat difference >&2; fail "abi.h or the catalogue is not an extension of $version"; }
if command -v abidiff >/dev/null; then
  abidiff --no-added-syms "$folder/$version/gcc/filters_kept.small.so" "$folder/new/filters_kept.small.so" \
    >difference || { cat difference >&2; fail "abidiff finds a difference"; }
else
  echo "  abidiff is not installed (Debian: abigail-tools); the table of offsets was compared"
fi

echo "manifests stay bound"
cp "$folder/$version/gcc"/filters_kept.small.* .
strip --strip-debug filters_kept.small.so
if command -v patchelf >/dev/null; then patchelf --set-rpath /nowhere filters_kept.small.so; fi
"$build/bin/weft" plugins why "$folder/filters_kept.small.so" >said 2>&1 || true
grep -q "can be used\|default: no plugin" said || fail "stripped, it is no longer bound: $(cat said)"
cc -std=c99 -DNEWER -fPIC -shared -Wl,--build-id=none -I "$repository/framework/include" \
  "$here/newer.c" -o nameless.so
"$build/bin/weft" plugins describe nameless.so >said 2>&1 && fail "a library without build-id is described"
expect_line said 'build-id' "a library without build-id"

test "$failures" = 0 || { echo "abi: $failures failures" >&2; exit 1; }
echo "abi: all is kept"

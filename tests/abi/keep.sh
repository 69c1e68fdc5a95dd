#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/abi/keep.sh VERSION DECISION [BUILD]
#
# Keeps the binaries that later versions must load, in kept/VERSION with their hashes. They are the
# plugins of this folder made by GCC and by Clang with libc++, and the host of BUILD (default
# build/release). Run it once for a release, and commit the files. DECISION is a page in
# docs/decisions, which gives the reason.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
repository=$(cd "$here/../.." && pwd)
usage="usage: tests/abi/keep.sh VERSION DECISION [BUILD]"
version=${1:?"$usage"}
decision=${2:?"$usage"}
build=$(cd "${3:-$repository/build/release}" && pwd)
test -f "$repository/$decision" || { echo "keep: there is no $decision" >&2; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir -p "$version/host"

# make NAME CC CXX FLAGS: the plugins into a folder of that name, without debugging information.
make() {
  cmake -S "$here/plugins" -B "build_$1" -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER="$2" \
    -DCMAKE_CXX_COMPILER="$3" -DCMAKE_CXX_FLAGS="$4" -Dweft_DIR="$build" \
    -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" >/dev/null
  cmake --build "build_$1" -j "$(nproc)" >/dev/null
  mkdir -p "$version/$1"
  cp "build_$1"/*.so "build_$1"/*.plugin.yaml "$version/$1"
  strip --strip-unneeded "$version/$1"/*.so
}
make gcc gcc g++ ""
make clang_libcxx clang clang++ "-stdlib=libc++"
cp "$build/tests/abi/weft_abi_host" "$version/host"
strip "$version/host/weft_abi_host"
"$here/needs_only_libc.sh" "$version/host/weft_abi_host"

kept=$here/kept/$version
rm -rf "$kept"
mkdir -p "$kept"
WEFT_PLUGIN_PATH=$folder/$version/gcc "$version/host/weft_abi_host" >"$kept/golden.txt"
WEFT_PLUGIN_PATH=$folder/$version/clang_libcxx "$version/host/weft_abi_host" |
  diff -u "$kept/golden.txt" - || { echo "keep: clang_libcxx answers otherwise than gcc" >&2; exit 1; }
{
  python3 "$here/layout.py" "$repository/framework/include/weft/abi.h"
  "$version/host/weft_abi_host" --catalogue
} >"$kept/layout.txt"
for part in gcc clang_libcxx host; do
  tar cf - --sort=name --owner=0 --group=0 --mtime=2000-01-01 "$version/$part" |
    xz -9e >"$kept/$part.tar.xz"
done
cd "$kept"
{ echo "# $decision" && sha256sum ./*.tar.xz golden.txt layout.txt; } >SHA256SUMS
ls -l "$kept"

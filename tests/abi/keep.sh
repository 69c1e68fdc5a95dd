#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/abi/keep.sh VERSION [BUILD]
#
# Keeps the binaries that later versions must load, in kept/VERSION with their hashes. They are the
# plugins of this folder made by GCC, by Clang with libc++ and from C, and the host of BUILD (default
# build/release). Run it once for a release, and commit the files. If golden.txt exists, the answers
# must be the same.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
repository=$(cd "$here/../.." && pwd)
version=${1:?"usage: tests/abi/keep.sh VERSION [BUILD]"}
build=$(cd "${2:-$repository/build/release}" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir -p "$version/host" "$version/c"

# make NAME COMPILER FLAGS: the plugins into a folder of that name, without debugging information.
make() {
  cmake -S "$here/plugins" -B "build_$1" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$2" \
    -DCMAKE_CXX_FLAGS="$3" -Dweft_DIR="$build" >/dev/null
  cmake --build "build_$1" >/dev/null
  mkdir -p "$version/$1"
  cp "build_$1"/*.so "build_$1"/*.plugin.yaml "$version/$1"
  strip --strip-unneeded "$version/$1"/*.so
}
make gcc g++ ""
make clang_libcxx clang++ "-stdlib=libc++"

cc -std=c99 -pedantic-errors -fPIC -shared -Wl,--build-id=sha1 -I "$repository/framework/include" \
  "$repository/docs/examples/c_filter/keep.c" -o "$version/c/filters_keep.so"
"$build/bin/weft" plugins describe "$version/c/filters_keep.so" >/dev/null
for role in sources templates detectors matchers; do
  cp "$version/gcc/${role}"_kept.small.* "$version/c"
done
cp "$build/tests/abi/weft_abi_host" "$version/host"
strip "$version/host/weft_abi_host"

golden=$here/golden.txt
test -e "$golden" ||
  WEFT_PLUGIN_PATH=$folder/$version/gcc "$version/host/weft_abi_host" >"$golden"
test -e "$here/layout.txt" ||
  python3 "$here/layout.py" "$repository/framework/include/weft/abi.h" >"$here/layout.txt"
for made_by in gcc clang_libcxx; do
  WEFT_PLUGIN_PATH=$folder/$version/$made_by "$version/host/weft_abi_host" | diff -u "$golden" - ||
    { echo "keep: $made_by answers otherwise than golden.txt" >&2; exit 1; }
done

rm -rf "$here/kept/$version"
mkdir -p "$here/kept/$version"
for part in gcc clang_libcxx c host; do
  tar cJf "$here/kept/$version/$part.tar.xz" --sort=name --owner=0 --group=0 --mtime=2000-01-01 \
    "$version/$part"
done
(cd "$here/kept/$version" && sha256sum ./*.tar.xz >SHA256SUMS)
ls -l "$here/kept/$version"

#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian packages of WEFT_BUILD_DIR, unpacks them in a separate folder and uses them. Checks the
# files of each package, their dependencies, and a plugin that is built against weft-dev.
set -eu

: "${WEFT_BUILD_DIR:?is not set: the folder of a build}"
repository=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "packages_test: $1" >&2
  exit 1
}

cd "$folder"
cpack --config "$WEFT_BUILD_DIR/CPackConfig.cmake" -G DEB -B "$folder/made" >cpack.log 2>&1 ||
  fail "$(tail -5 cpack.log)"
for name in weft weft-plugins weft-dev; do
  set -- made/"$name"_*.deb
  test -e "$1" || fail "there is no package $name"
  test "$(dpkg-deb --field "$1" Package)" = "$name" || fail "$1 is another package"
  dpkg-deb --field "$1" Depends >"$name.depends"
  dpkg-deb --fsys-tarfile "$1" | tar t >"$name.files"
  dpkg-deb --extract "$1" root
done
duplicates=$(cat ./*.files | grep -v '/$' | sort | uniq -d)
test -z "$duplicates" || fail "in two packages: $duplicates"

echo "-- what is in which"
grep -q '^\./usr/bin/weft$' weft.files || fail "weft has no program"
grep -q '^\./usr/lib/weft/plugins/filters_aem.so$' weft-plugins.files || fail "weft-plugins has no plugins"
grep -q '^\./usr/include/weft/abi.h$' weft-dev.files || fail "weft-dev has no headers"
if grep -E '\.so$' weft.files | grep -v count_allocations; then fail "weft has the libraries above"; fi
if grep -qE 'opencv|embree' weft.depends; then fail "weft alone depends on $(cat weft.depends)"; fi
grep -q 'libopencv-core' weft-plugins.depends || fail "weft-plugins depends on: $(cat weft-plugins.depends)"
for name in weft-plugins weft-dev; do
  grep -qE '(^|, )weft( |,|$)' "$name.depends" || fail "$name does not depend on weft: $(cat "$name.depends")"
done

echo "-- installed on this machine they would need"
if command -v apt-get >/dev/null; then
  apt-get install --simulate --no-install-recommends ./made/*.deb >apt.log 2>&1 ||
    fail "apt does not take them: $(tail -5 apt.log)"
  grep -c '^Inst' apt.log
fi

echo "-- a composer"
root=$folder/root/usr
unset WEFT_PLUGIN_PATH || true
"$root/bin/weft" run "$root/share/weft/pipelines/demo.yaml" --set source.frames=2 --quiet --out run
test "$(grep -c '"state":"estimated"' run/frames.jsonl)" = 2 || fail "the sheet was not found in two frames"
"$root/bin/weft" plugins list | grep -q 'refused' && fail "a plugin of the package is refused"

echo "-- an author, with the files of weft-dev"
cp "$repository/docs/examples/c_filter/keep.c" .
PKG_CONFIG_PATH=$root/lib/pkgconfig sh -eu -c "$(grep '^cc ' "$repository/docs/examples/c_filter/README.md")"
"$root/bin/weft" plugins describe filters_keep.so >/dev/null
cp -r "$repository/docs/examples/own_records" plugin
cmake -S plugin -B build -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$root" \
  ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"} >/dev/null
cmake --build build >/dev/null
"$root/bin/weft" plugins show stages/acme.in_focus --plugin-path build >/dev/null ||
  fail "the plugin is not found"
echo "packages_test: all is well"

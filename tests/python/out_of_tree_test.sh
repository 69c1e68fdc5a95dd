#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds docs/examples/python_filter as its reader would, in a separate folder, against the package in
# WEFT_BUILD_DIR, and again after a change.
set -eu

: "${WEFT_BUILD_DIR:?is not set: the folder with weftConfig.cmake}"
source=$(cd "$(dirname "$0")/../../docs/examples/python_filter" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "out_of_tree_test: $1" >&2
  exit 1
}

cp -r "$source" "$folder/plugin"
cd "$folder/plugin"
cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -Dweft_DIR="$WEFT_BUILD_DIR" \
  ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"}
cmake --build build
(cd build && ctest --output-on-failure --no-tests=error) || fail "the contract is not kept"

library=build/filters_local_motion_numpy.so
symbols=$(nm -D --defined-only "$library" | awk '{print $NF}')
test "$symbols" = weft_library || fail "exports more than one symbol: $symbols"

build_id_of() { readelf -n "$1" | awk '/Build ID:/ {print $3}'; }
before=$(build_id_of "$library")
sed -i 's/"maximum distance from median"/"changed help"/' local_motion.py
cmake --build build
grep -q "changed help" build/filters_local_motion_numpy.plugin.yaml || fail "the manifest is not of the change"
test "$(build_id_of "$library")" != "$before" || fail "a changed module has the build-id of the old one"

rm local_motion.py
"$WEFT_BUILD_DIR/bin/weft" run --plugin-path build "$source/pipeline.yaml" --quiet --out run \
  --set source.trials=2
test "$(grep -c '"stage":"filters","status":"ok"' run/frames.jsonl)" = 2 ||
  fail "the filter did not answer in two frames"
lines=$(wc -l < "$source/local_motion.py")
test "$lines" -lt 40 || fail "local_motion.py has $lines lines; the promise is less than 40"
echo "out_of_tree_test: all is well"

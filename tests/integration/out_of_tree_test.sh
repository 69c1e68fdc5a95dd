#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds docs/examples/your_own_filter as its reader would, in a separate folder, against the
# package in WEFT_BUILD_DIR.
set -eu

: "${WEFT_BUILD_DIR:?is not set: the folder with weftConfig.cmake}"
source=$(cd "$(dirname "$0")/../../docs/examples/your_own_filter" && pwd)
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

library=build/filters_local_motion.so
manifest=build/filters_local_motion.plugin.yaml
test -f "$library" || fail "there is no $library"
test -f "$manifest" || fail "there is no $manifest"

symbols=$(nm -D --defined-only "$library" | awk '{print $NF}')
test "$symbols" = weft_library || fail "exports more than one symbol: $symbols"

for expected in 'id: "filters/local_motion"' 'name: "radius_px"' 'unit: "px"' 'range: [1, 1000]'; do
  grep -qF "$expected" "$manifest" || fail "the manifest lacks: $expected"
done

build_id=$(readelf -n "$library" | awk '/Build ID:/ {print $3}')
grep -qF "build_id: \"$build_id\"" "$manifest" || fail "the manifest is not of this build"

repository=$(cd "$source/../../.." && pwd)
cat > pipeline.yaml <<YAML
weft: 1
source:
  use: sources/synthetic
  params: {texture: "$repository/pipelines/data/sheet_texture.png", width_m: 0.297, frames: 2}
template:
  use: templates/rectangular
  params: {texture: "$repository/pipelines/data/sheet_texture.png", width_m: 0.297}
stages:
  - use: detectors/sift
  - use: matchers/descriptor
  - use: filters/local_motion
    params: {radius_px: 80, max_deviation_px: 40}
  - use: warps/bbs
  - use: passes/salient_cells
  - use: solvers/brunet_mdh
YAML
"$WEFT_BUILD_DIR/bin/weft" run --plugin-path build pipeline.yaml --out run
test "$(grep -c '"stage":"filters","status":"ok"' run/frames.jsonl)" = 2 ||
  fail "the filter did not answer in two frames"

cp -r "$repository/docs/examples/embed" "$folder/embed"
cmake -S "$folder/embed" -B "$folder/embedding" -Dweft_DIR="$WEFT_BUILD_DIR" \
  ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"}
cmake --build "$folder/embedding"
said=$("$folder/embedding/embed" nowhere.yaml 2>&1) && fail "embed takes a pipeline that is not there"
echo "$said" | grep -qF "nowhere.yaml: there is no such file" || fail "embed says: $said"

lines=$(wc -l < local_motion.cpp)
test "$lines" -lt 40 || fail "local_motion.cpp has $lines lines; the promise is less than 40"
echo "out_of_tree_test: all is well"

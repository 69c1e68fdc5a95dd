#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the build of WEFT_BUILD_DIR, moves it, and uses it as composers and plugin authors would.
set -eu

: "${WEFT_BUILD_DIR:?is not set: the folder of a build}"
repository=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "installed_test: $1" >&2
  exit 1
}

cd "$folder"
cmake --install "$WEFT_BUILD_DIR" --prefix "$folder/here" >/dev/null
mv here elsewhere
prefix=$folder/elsewhere
PATH=$prefix/bin:$PATH
unset WEFT_PLUGIN_PATH || true

for text in include lib/cmake lib/pkgconfig lib/weft/plugins/*.yaml; do
  # shellcheck disable=SC2086
  for place in "$repository" "$WEFT_BUILD_DIR" "$folder/here"; do
    if grep -rlF "$place" "$prefix"/$text; then fail "the files above name $place"; fi
  done
done

echo "-- pages and completions"
for page in weft weft-run weft-plugins-show weft-data-make-frex; do
  grep -q "^\.SH SYNOPSIS" "$prefix/share/man/man1/$page.1" || fail "there is no page $page.1"
done
if command -v man >/dev/null; then
  for page in "$prefix"/share/man/man1/*.1; do
    warnings=$(MANWIDTH=200 man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null)
    test -z "$warnings" || fail "$page: $warnings"
  done
fi
for script in bash-completion/completions/weft zsh/vendor-completions/_weft \
  fish/vendor_completions.d/weft.fish; do
  grep -q 'plugins show' "$prefix/share/$script" || fail "$script does not complete"
done

echo "-- a composer"
weft doctor >doctor.txt || fail "$(cat doctor.txt)"
weft run "$prefix/share/weft/pipelines/demo.yaml" --set source.frames=2 --quiet --out run
weft run "$prefix/share/weft/pipelines/demo.yaml" --set source.frames=2 --quiet --out apart \
  --set filters.isolate=process
test "$(grep -c '"state":"estimated"' run/frames.jsonl apart/frames.jsonl | grep -c ':2$')" = 2 ||
  fail "the sheet was not found in two frames"

if test -x "$WEFT_BUILD_DIR/bin/weft-calibrate"; then
  weft calibrate board --out board.pdf >/dev/null || fail "weft calibrate does not find its program"
fi

echo "-- a plugin author"
weft plugins new filter mine >/dev/null || fail "weft plugins new does not find what it copies"
test -f mine/CMakeLists.txt || fail "weft plugins new made no CMakeLists.txt"

echo "-- a program that embeds a pipeline"
cat >kept.yaml <<TEXT
weft: 1
extends: $prefix/share/weft/pipelines/demo.yaml
source: {params: {frames: 2}}
sinks:
  - {use: sinks/dataset, as: kept, params: {path: kept, dense_truth: false}}
TEXT
weft run kept.yaml --quiet --out given
cp -r "$repository/docs/examples/embed" embed
cmake -S embed -B embedding -DCMAKE_PREFIX_PATH="$prefix" ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"} >/dev/null
cmake --build embedding >/dev/null
python3 "$repository/tests/integration/embedding/raw_frames.py" given/kept/frames/*.png >frames.bgr
(unset WEFT_PLUGIN_PATH && cd / && "$folder/embedding/embed" \
  "$prefix/share/weft/pipelines/demo.yaml" <"$folder/frames.bgr") >embedded.jsonl
for lines in given/frames.jsonl embedded.jsonl; do
  grep -oE '"state":"[a-z]+","age":[0-9]+,"confidence":[0-9.e-]+' "$lines" >"$lines.told"
done
cmp given/frames.jsonl.told embedded.jsonl.told || fail "an embedded pipeline gives other shapes"
test "$(grep -c estimated embedded.jsonl.told)" = 2 || fail "an embedded pipeline finds no sheet"

if ls "$prefix"/lib/python3/dist-packages/weft/programs/_pipeline*.so >/dev/null 2>&1; then
  echo "-- a program in Python"
  (cd / && PYTHONPATH=$prefix/lib/python3/dist-packages "${WEFT_PYTHON:-python3}" - "$folder" \
    "$prefix/share/weft/pipelines/demo.yaml" >"$folder/python.jsonl" <<'TEXT'
import sys

import numpy as np
import weft

folder, demo = sys.argv[1:]
camera = weft.open_run(folder + "/given").camera
images = np.fromfile(folder + "/frames.bgr", np.uint8).reshape(-1, 480, 640, 3)
with weft.Pipeline(demo, camera, set={"filters.isolate": "process"}) as pipeline:
    for image in images:
        print(pipeline.process(image).report_json)
TEXT
  )
  grep -oE '"state":"[a-z]+","age":[0-9]+,"confidence":[0-9.e-]+' python.jsonl >python.jsonl.told
  cmp given/frames.jsonl.told python.jsonl.told || fail "a pipeline in Python gives other shapes"
fi

echo "-- an author in C"
cp "$repository/docs/examples/c_filter/keep.c" .
PKG_CONFIG_PATH=$prefix/lib/pkgconfig sh -eu -c "$(grep '^cc ' "$repository/docs/examples/c_filter/README.md")"
weft plugins describe filters_keep.so >/dev/null
weft plugins show filters/keep --plugin-path . | grep -q max_deviation_px || fail "the filter in C is not found"

echo "-- an author in C++"
cp -r "$repository/docs/examples/your_own_filter" plugin
cmake -S plugin -B build -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$prefix" \
  ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"} >/dev/null
cmake --build build >/dev/null
(cd build && ctest --output-on-failure --no-tests=error) || fail "the contract is not kept"
cmake --install build --prefix "$prefix" >/dev/null
weft plugins show filters/local_motion | grep -q radius_px || fail "the plugin is not installed"

echo "-- an author without Eigen, and with a symbol that there is not"
mkdir small
cat >small/CMakeLists.txt <<'TEXT'
cmake_minimum_required(VERSION 3.25)
project(small LANGUAGES CXX)
find_package(weft REQUIRED)
weft_add_plugin(filters/left_half SOURCES without_eigen.cpp)
weft_add_plugin(filters/undefined SOURCES undefined.cpp)
TEXT
cp "$repository/tests/headers/without_eigen.cpp" small
sed 's/left_half/undefined/; s/solvers.still/solvers\/undefined/; s/namespace {/extern "C" double nowhere(); namespace {/
     s/share_ \*/nowhere() */' small/without_eigen.cpp >small/undefined.cpp
cmake -S small -B smaller -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON \
  ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"} >/dev/null
cmake --build smaller --target filters_left_half_manifest >/dev/null
weft plugins show solvers/still --plugin-path smaller >/dev/null || fail "a plugin without Eigen is not found"
! cmake --build smaller --target filters_undefined >said.txt 2>&1 || fail "a symbol is missing, and nobody says so"
grep -q "undefined reference to .nowhere" said.txt || fail "$(cat said.txt)"

echo "-- an author with tests"
mkdir tests
cat >tests/CMakeLists.txt <<'TEXT'
cmake_minimum_required(VERSION 3.25)
project(tests LANGUAGES CXX)
enable_testing()
find_package(GTest REQUIRED)
find_package(weft REQUIRED COMPONENTS testing)
weft_add_plugin(filters/tested SOURCES tested.cpp TESTS tested_test.cpp)
TEXT
sed 's/LocalMotion/Tested/; s/struct LocalMotion/struct Tested/; s/LocalMotion(/Tested(/; s/(LocalMotion,/(Tested,/;
     s|filters/local_motion|filters/tested|' plugin/local_motion.cpp >tests/tested.cpp
cat >tests/tested_test.cpp <<'TEXT'
#include <gtest/gtest.h>
#include <weft/testing/plugin_under_test.hpp>

TEST(Tested, CanBeMade) { weft::testing::PluginUnderTest plugin("filters/tested", "{}"); }
TEXT
cmake -S tests -B tested -DCMAKE_PREFIX_PATH="$prefix" ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"} >/dev/null
cmake --build tested >/dev/null
(cd tested && ctest --output-on-failure --no-tests=error) || fail "the tests do not pass"
echo "installed_test: all is well"

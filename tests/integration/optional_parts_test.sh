#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Configures the tree as on a machine without OpenCL, Ceres and OpenCV's module aruco. CMake omits and
# names the plugins that need them; the rest can be built, with its tests.
set -eu

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "optional_parts_test: $1" >&2
  exit 1
}

cmake -S "$1" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_DISABLE_FIND_PACKAGE_OpenCL=ON -DWEFT_OPENCV_ARUCO_INCLUDE= -DWEFT_CERES_INCLUDE= >"$folder/said" \
  || fail "configuring failed"
ninja -C "$folder/build" -t targets all >"$folder/targets"
(cd "$folder/build" && ctest -N) >"$folder/tests"

for plugin in detectors/sift_gpu solvers/brunet_refine templates/frex_sheet sources/frex_video; do
  name=$(echo "$plugin" | tr / _)
  grep -q "Left out: $plugin needs .*Debian: " "$folder/said" || fail "nothing says that $plugin is left out"
  ! grep -q "$name" "$folder/targets" || fail "$name is still to be built"
done
grep -q "Left out: weft calibrate needs .*Debian: " "$folder/said" || fail "nothing says that weft calibrate is left out"
! grep -q weft_calibrat "$folder/targets" || fail "weft_calibrate is still to be built"
! grep -qE 'sift_gpu|frex_video|frex_sheet|calibra|: notice$|documented_commands' "$folder/tests" \
  || fail "a test is left that cannot pass"
for name in filters_myneighbor_test sources_frex_test template_test sinks_drawing_test; do
  grep -q ": $name\$" "$folder/tests" || fail "$name is lost, too"
done

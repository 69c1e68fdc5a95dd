#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds docs/examples/own_records by the commands of its page, in a separate folder. Its stages use a
# record type unknown to the host, in this process and in another one, dumped and replayed.
set -eu

: "${WEFT_BUILD_DIR:?is not set: the folder with weftConfig.cmake}"
repository=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
weft=$WEFT_BUILD_DIR/bin/weft

fail() {
  echo "own_records_test: $1" >&2
  exit 1
}

mkdir -p "$folder/docs/examples" "$folder/pipelines"
cp -r "$repository/docs/examples/own_records" "$folder/docs/examples"
ln -s "$repository/pipelines/data" "$folder/pipelines/data"
cd "$folder/docs/examples/own_records"
cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -Dweft_DIR="$WEFT_BUILD_DIR" \
  ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"} >/dev/null
cmake --build build >/dev/null || fail "it does not build"
manifest=build/stages_acme.sharpness.plugin.yaml
grep -qF '{name: "variance", type: f64, shape: "R,C", unit: "grey levels^2"' $manifest ||
  fail "the manifest does not declare the record"
"$weft" plugins show stages/acme.in_focus --plugin-path build >shown
grep -q 'acme.sharpness\*' shown || fail "the stage is shown without its slots: $(cat shown)"

"$weft" run pipeline.yaml --plugin-path build --quiet --out run --dump sharpness
for stage in sharpness in_focus solvers; do
  test "$(grep -c "\"stage\":\"$stage\",\"status\":\"ok\"" run/frames.jsonl)" = 5 ||
    fail "the stage $stage did not answer in five frames"
done
"$weft" replay sharpness run --plugin-path build || fail "replayed, it answers otherwise"
"$weft" run pipeline.yaml --plugin-path build --quiet --out apart --set sharpness.isolate=process \
  --set in_focus.isolate=process --dump sharpness
for run in run apart; do
  grep -oE '"state":"[a-z]+","age":[0-9]+,"confidence":[0-9.e-]+' $run/frames.jsonl >$run.told
done
cmp run.told apart.told || fail "in processes of their own the stages lead to other shapes"

echo "-- what does not fit"
"$weft" check pipeline.yaml --plugin-path build --set without=sharpness >said 2>&1 &&
  fail "a record that nobody makes is not missed"
grep -q "requires 'acme.sharpness'.*" said || fail "of a missing record it says: $(cat said)"
grep -q "add one that produces it: stages/acme.sharpness" said || fail "no maker is named: $(cat said)"

mkdir other
sed '1,/WEFT_LIBRARY/!d; s/WEFT_LIBRARY.*//' sharpness.cpp >other/sharpness.cpp
cat >>other/sharpness.cpp <<'TEXT'
WEFT_PLUGIN(acme::InFocus, "stages/other.in_focus", "1.0.0", "Of another vendor.")
TEXT
sed 's/"R,C"/"C,R"/' sharpness.hpp >other/sharpness.hpp
sed 's/own_records/other/; s/acme.sharpness/other.in_focus/' CMakeLists.txt >other/CMakeLists.txt
cmake -S other -B otherwise -DCMAKE_BUILD_TYPE=Release -Dweft_DIR="$WEFT_BUILD_DIR" \
  ${CXX:+-DCMAKE_CXX_COMPILER="$CXX"} >/dev/null
cmake --build otherwise >/dev/null 2>&1 || fail "the other one does not build"
"$weft" check pipeline.yaml --plugin-path build --plugin-path otherwise \
  --set in_focus.use=stages/other.in_focus >said 2>&1 && fail "two declarations of a record are taken"
grep -q 'declares other arrays for acme.sharpness/1 than stages/acme.sharpness' said ||
  fail "of another declaration it says: $(cat said)"
sed -i 's|acme.sharpness/1|acme.sharpness/2|' other/sharpness.hpp
cmake --build otherwise >/dev/null 2>&1 || fail "the newer one does not build"
"$weft" check pipeline.yaml --plugin-path build --plugin-path otherwise \
  --set in_focus.use=stages/other.in_focus >said 2>&1 && fail "another version of a record is taken"
grep -q "reads acme.sharpness/2, and 'sharpness' makes acme.sharpness/1" said ||
  fail "of another version it says: $(cat said)"

sed -i 's/needs = "image acme.sharpness"/needs = "image"/' other/sharpness.cpp
cmake --build otherwise >said 2>&1 && fail "a slot that kAbout does not name is taken"
grep -q "its slot 'acme.sharpness' is missing in kAbout.needs" said ||
  fail "of a slot that is not named it says: $(cat said)"
sed -i 's/needs = "image"/needs = "image acme.sharpness imgae"/' other/sharpness.cpp
cmake --build otherwise >said 2>&1 && fail "a slot that nobody makes is taken"
grep -q "names 'imgae', which is no input of any role.*did you mean 'image'" said ||
  fail "of a misspelt slot it says: $(cat said)"
echo "own_records_test: all is well"

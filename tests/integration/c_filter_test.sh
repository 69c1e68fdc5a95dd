#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds docs/examples/c_filter by the commands of its page, in a separate folder, against the package
# in WEFT_BUILD_DIR; and the contract as C99 by each compiler that is there.
set -eu

: "${WEFT_BUILD_DIR:?is not set: the folder with weft.pc}"
source=$(cd "$(dirname "$0")/../../docs/examples/c_filter" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "c_filter_test: $1" >&2
  exit 1
}

cp "$source/keep.c" "$folder"
cd "$folder"
export PKG_CONFIG_PATH="$WEFT_BUILD_DIR"
weft=$WEFT_BUILD_DIR/bin/weft

for compiler in cc gcc clang; do
  command -v "$compiler" >/dev/null || continue
  # shellcheck disable=SC2046
  "$compiler" -std=c99 -pedantic-errors -Wall -Wextra -Werror -fsyntax-only keep.c \
    $(pkg-config --cflags weft) || fail "$compiler does not take the filter as C99"
done

line=$(grep '^cc ' "$source/README.md") || fail "the page does not say how to build it"
sh -eu -c "$line"
symbols=$(nm -D --defined-only filters_keep.so | awk '{print $NF}')
test "$symbols" = weft_library || fail "exports more than one symbol: $symbols"

"$weft" plugins describe filters_keep.so >said || fail "cannot be described"
grep -q filters_keep.plugin.yaml said || fail "describe says: $(cat said)"
for expected in 'id: "filters/keep"' 'name: "max_deviation_px"' 'unit: "px"' 'range: [0, 10000]' \
  'default: 100'; do
  grep -qF "$expected" filters_keep.plugin.yaml || fail "the manifest lacks: $expected"
done

"$weft" plugins check filters_keep.so || fail "the contract is not kept"

"$weft" run "$source/pipeline.yaml" --plugin-path . --quiet --out run
test "$(grep -c '"stage":"filters","status":"ok"' run/frames.jsonl)" = 4 ||
  fail "the filter did not answer in four frames"
"$weft" run "$source/pipeline.yaml" --plugin-path . --quiet --out apart --set filters.isolate=process
test "$(grep -c '"stage":"filters","status":"ok"' apart/frames.jsonl)" = 4 ||
  fail "the filter did not answer in four frames in a process of its own"
if "$weft" check "$source/pipeline.yaml" --plugin-path . --set filters.max_deviation_px=-1 >said 2>&1; then
  fail "a parameter outside of its range was taken"
fi
grep -q max_deviation_px said || fail "of a parameter outside of its range it says: $(cat said)"

lines=$(wc -l <keep.c)
test "$lines" -lt 150 || fail "keep.c has $lines lines; the promise is less than 150"
echo "c_filter_test: all is well"

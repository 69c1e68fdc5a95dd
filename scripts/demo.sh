#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds Weft, runs pipelines/demo.yaml, evaluates it, writes its report and says where all of it is.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/common.sh
source scripts/common.sh

for argument in "$@"; do
  [[ $argument == --without-* ]] && continue
  echo "usage: scripts/demo.sh [--without-...]: installs packages (scripts/bootstrap.sh --help says"
  echo "which can be left out), builds, runs pipelines/demo.yaml"
  [[ $argument == -h || $argument == --help ]] && exit 0
  exit 2
done

fail() {
  echo >&2
  echo "demo.sh: $1" >&2
  exit 1
}

echo "1/5 Packages"
scripts/bootstrap.sh "$@" || fail "packages could not be installed; the list is in scripts/bootstrap.sh"

echo "2/5 Build of the program and of the plugins of the demo (the first time takes minutes)"
weft_logged build/release/configure.log cmake --preset release \
  || fail "configuring failed; see build/release/configure.log"
weft_logged build/release/build.log \
  cmake --build --preset release --target weft_demo -j "$(weft_jobs)" \
  || fail "the build failed; see build/release/build.log"

run=runs/demo
if [[ -e $run ]]; then
  run=runs/demo-$(date +%Y%m%d-%H%M%S)
fi
mkdir -p runs

echo "3/5 Run pipelines/demo.yaml"
build/release/bin/weft run pipelines/demo.yaml --out "$run" || {
  status=$?
  case $status in
    1) why="some frames failed; their reasons are in $run/frames.jsonl" ;;
    2) why="the pipeline was refused; 'build/release/bin/weft check pipelines/demo.yaml' says why" ;;
    3) why="a file could not be read or written; the message above names it" ;;
    *) why="the program ended with status $status; please report it with the output above" ;;
  esac
  fail "$why"
}

echo "4/5 Evaluate"
build/release/bin/weft eval "$run" \
  || fail "the run is complete, but its evaluation failed; the results are in $PWD/$run"

echo "5/5 Report"
build/release/bin/weft report "$run" > build/release/report.log \
  || fail "the run is complete, but its report failed; the results are in $PWD/$run"

# show TITLE FIND-EXPRESSION...: the files that match, or their folder where there are many.
show() {
  local title=$1 file files
  shift
  mapfile -t files < <(find "$PWD/$run" -type f \( "$@" \) | sort)
  if ((${#files[@]} > 3)); then
    printf '  %-8s %s (%d files)\n' "$title" "$(dirname "${files[0]}")" "${#files[@]}"
    return 0
  fi
  for file in "${files[@]}"; do
    printf '  %-8s %s\n' "$title" "$file"
  done
}
echo
echo "Results"
show overlay -name '*.mp4' -o -name '*.avi' -o -name '*.mkv'
show meshes -name '*.obj' -o -name '*.ply'
show metrics -name 'metrics*.json'
show run -name manifest.json
echo
echo "Open this page in a browser: $PWD/$run/report.html"
echo "The other plugins are built by: cmake --build build/release --target weft_installed"
# The second line of `times` is about the commands that were run. A subshell has none.
times >build/release/times.txt
echo "Processor time (user, system): $(tail -n 1 build/release/times.txt)"

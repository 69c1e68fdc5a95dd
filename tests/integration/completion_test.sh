#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Completes command lines as an interactive bash would: completion_test.sh WEFT PLUGINS
set -euo pipefail

: "${2:?usage: completion_test.sh WEFT PLUGINS}"
PATH=$(dirname "$1"):$PATH
export WEFT_PLUGIN_PATH=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir runs
touch runs.yaml
# shellcheck disable=SC1090
source <(weft completion bash)

failures=0
# expect WORDS LINE: what completes the last word of the line, in any order, holds all these words.
expect() {
  local wanted=$1 word
  shift
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  COMPREPLY=()
  _weft || true # outside of a real completion compopt fails
  for word in $wanted; do
    if [[ " ${COMPREPLY[*]} " != *" $word "* ]]; then
      echo "completion_test: '$*' is not completed by $word, but by: ${COMPREPLY[*]}" >&2
      failures=$((failures + 1))
    fi
  done
}
# expect_only WORDS LINE: and by nothing else.
expect_only() {
  expect "$@"
  # shellcheck disable=SC2086
  set -- $1
  if ((${#COMPREPLY[@]} != $#)); then
    echo "completion_test: ${#COMPREPLY[@]} words in place of $#: ${COMPREPLY[*]}" >&2
    failures=$((failures + 1))
  fi
}

expect 'run check plugins manual' weft ''
expect_only 'replay records report run' weft r
expect_only 'list show why describe check new' weft plugins ''
expect '--help --version --plugin-path' weft -
expect '--set --out --dump --quiet --plugin-path' weft run -
expect_only 'runs runs.yaml' weft run ru
printf 'weft: 1\nsource: {use: sources/test.scripted}\ntemplate: {use: templates/test.scripted}\n' >runs.yaml
expect_only 'source.frames= source.focal_px=' weft run runs.yaml --set source.f
expect 'seed= template.columns=' weft check runs.yaml --set ''
expect_only '' weft run --set source.f
expect_only 'runs' weft run --out ru
expect_only 'runs' weft --plugin-path ru
expect_only 'none scale rigid all' weft eval --alignment ''
expect_only 'bash zsh fish' weft completion ''
expect_only 'pipeline plan' weft schema ''
expect_only 'warps/test.scripted' weft plugins show warps/test
expect_only 'frex' weft data make ''
expect '--seed' weft data make frex -

# Every command and option of the program's help is there.
for command in run check eval ablate 'data make frex'; do
  # shellcheck disable=SC2086
  options=$(weft $command --help | grep -oE -- '^ +(-h,)?--[a-z-]+' | grep -oE -- '--[a-z-]+')
  # shellcheck disable=SC2086
  expect "$options" weft $command -
done

for shell in zsh fish; do
  weft completion "$shell" >"script.$shell"
  if command -v "$shell" >/dev/null; then "$shell" -n "script.$shell"; fi
done
((failures == 0)) && echo "completion_test: all is well"

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds and tests the repository on a fresh Debian 12; see --help.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/common.sh
source scripts/common.sh

usage() {
  cat <<'TEXT'
usage: scripts/test.sh [--ci [--since REV] | --long] [--coverage] [--with-slurm] [--jobs N] [--without-...]

Installs missing packages, builds the preset release and runs its tests labelled `quick`. Exits 1 if
anything failed.

  --ci      also: clang-format over all tracked sources; each installed header compiled alone by GCC
            and by Clang, and abi.h as C99; under AddressSanitizer and UndefinedBehaviorSanitizer the
            unit tests of the framework, the program with hostile and malformed input, plugins that
            misbehave and the plugins that changed, with the others as they are; clang-tidy over
            what changed
  --since REV
            what changed since REV (default: since the branch left main, on main since the commit
            before)
  --long    also what neither of these runs: the tests labelled `long`; all tests under
            AddressSanitizer; the quick tests under ThreadSanitizer, of plugins those that start
            threads; clang-tidy over everything; each fuzzer of tests/hostile/fuzz for a minute; and the
            benchmarks of the stages and of the host (build/benchmarks.log)
  --coverage
            also: the quick tests in the preset coverage, and the share of lines that they run
  --with-slurm
            installs Slurm, and runs ablations on a cluster of it that listens on loopback
  --without-contrib, --without-opencl, --without-pocl
            install less, see scripts/bootstrap.sh --help; what is not there is not tested
  --jobs N  compile and test N at a time (default: cores + 1, at most one for each 3 GiB of memory)
  --help    this text

Tests on recorded data look for it in $WEFT_DATA. Where that is unset and ../shared/data exists, it
is set to that folder; where there is none, those tests are skipped and listed at the end.
Logs: build/<preset>/{configure,build,test-quick,test-long}.log, build/*.log
TEXT
}

refuse() {
  echo "test.sh: $1" >&2
  exit 2
}

ci=0
long=0
coverage=0
since=
packages=()
jobs=$(weft_jobs)
while (($#)); do
  case $1 in
    --ci) ci=1 ;;
    --long) long=1 ;;
    --coverage) coverage=1 ;;
    --with-slurm) packages+=("$1") && export WEFT_SLURM=1 ;;
    --without-*) packages+=("$1") ;;
    --since)
      since=${2:-}
      git rev-parse --verify --quiet "$since^{commit}" >/dev/null \
        || refuse "--since needs a commit of this clone, not '$since'"
      shift
      ;;
    --jobs)
      jobs=${2:-}
      [[ $jobs =~ ^[1-9][0-9]*$ ]] || refuse "--jobs needs a number, not '$jobs'"
      shift
      ;;
    -h | --help) usage; exit 0 ;;
    *) refuse "unknown argument '$1'; see --help" ;;
  esac
  shift
done
((ci == 0 || long == 0)) || refuse "--ci and --long are two runs"
[[ -z $since ]] || ((ci)) || refuse "--since goes with --ci"

# Settings of the user's own runs, such as a plugin path or a token, are not those of the tests.
for variable in "${!WEFT_@}"; do
  [[ $variable =~ ^WEFT_(DATA|SLURM)$ ]] || unset "$variable"
done
if [[ -z ${WEFT_DATA+set} && -d ../shared/data ]]; then
  WEFT_DATA=$(cd ../shared/data && pwd)
  export WEFT_DATA
fi

summary=()
skipped=()
covered=
failures=0

# note RESULT SECONDS NAME [DETAIL]
note() { summary+=("$(printf '%-8s %5s s  %s%s' "$1" "$2" "$3" "${4:+ ($4)}")"); }

# step NAME LOG COMMAND...: runs, times and records it; its status is that of the command. The last
# line of the log may add details of the success: `summary: RESULT: DETAIL`.
step() {
  local name=$1 log=$2 start=$SECONDS result=ok detail
  shift 2
  printf '%-16s ... ' "$name"
  if ! weft_logged "$log" "$@"; then
    failures=$((failures + 1))
    note FAILED $((SECONDS - start)) "$name" "$log"
    return 1
  fi
  detail=$(grep -oE '[0-9]+% tests passed.*|No tests were found.*' "$log" | tail -n 1 || true)
  if [[ $(tail -n 1 "$log") =~ ^summary:\ ([^:]+):\ (.*)$ ]]; then
    result=${BASH_REMATCH[1]}
    detail=${BASH_REMATCH[2]}
  fi
  echo "$result, $((SECONDS - start)) s${detail:+, $detail}"
  note "$result" $((SECONDS - start)) "$name" "$detail"
}

# build PRESET [TARGET [SETTING...]]: of everything where the target is empty.
build() {
  local preset=$1 target=${2:-}
  shift $(($# < 2 ? $# : 2))
  step "$preset configure" "build/$preset/configure.log" cmake --preset "$preset" "$@" \
    && step "$preset build" "build/$preset/build.log" \
      cmake --build --preset "$preset" -j "$jobs" ${target:+--target "$target"}
}

# Adds tests that CTest or GoogleTest skipped in the last run of the preset.
collect_skipped() {
  local preset=$1 name log=build/$1/Testing/Temporary/LastTest.log
  [[ -f $log ]] || return 0
  while IFS= read -r name; do
    skipped+=("$preset  $name")
  done < <(
    {
      grep -oE '^\[  SKIPPED \] [A-Za-z_0-9/]+\.[^ ]+' "$log" | sed 's/^\[  SKIPPED \] //' || true
      sed -nE 's/^ *[0-9]+\/[0-9]+ +Test +#[0-9]+: ([^ ]+) \.*\*\*\*(Skipped|Not Run).*/\1/p' \
        "build/$preset/$2.log"
    } | sort -u
  )
}

# run_tests PRESET quick|long error|ignore: the last argument rates an empty set of tests.
run_tests() {
  local preset=$1 label=$2 none=$3 status=0
  step "$preset $label" "build/$preset/test-$label.log" \
    ctest --preset "$preset" -L "^$label\$" -j "$jobs" --no-tests="$none" || status=1
  collect_skipped "$preset" "test-$label"
  return "$status"
}

# build_and_test PRESET [SETTING...]: with --long also its long tests, but for ThreadSanitizer.
build_and_test() {
  local preset=$1
  shift
  if ! build "$preset" "" "$@"; then
    note "NOT RUN" 0 "$preset tests"
    return 0
  fi
  run_tests "$preset" quick error || true
  if ((long)) && [[ $preset != tsan ]]; then
    run_tests "$preset" long ignore || true
  fi
}

# The commit that changes are counted from; nothing where none is known, as in a shallow clone.
base_commit() {
  local branch common
  for branch in upstream/main origin/main main; do
    common=$(git merge-base HEAD "$branch" 2>/dev/null) || continue
    if [[ $common != "$(git rev-parse HEAD)" ]]; then
      echo "$common"
      return 0
    fi
  done
  git rev-parse --verify --quiet HEAD~1 || true
}

# changed_plugins REV: folders below plugins/ that changed since, as role/name, and those that link
# a common library that did; with blanks between.
changed_plugins() {
  local changed id
  changed=$({ git diff --name-only "$1" -- plugins && git ls-files --others --exclude-standard plugins; } \
    | cut -d / -f 2,3 | sort -u)
  for id in $changed; do
    echo "$id"
    [[ $id == common/* || $id == */common ]] || continue
    grep -lwE "${id/\//_}" plugins/*/*/CMakeLists.txt | cut -d / -f 2,3 || true
  done | sort -u | while IFS= read -r id; do
    [[ ! -f plugins/$id/CMakeLists.txt ]] || echo "$id"
  done
}

check_format() {
  git rev-parse --is-inside-work-tree >/dev/null \
    && git ls-files -z -- '*.h' '*.hpp' '*.c' '*.cpp' | xargs -0 -r clang-format --dry-run --Werror
}

check_headers() {
  cmake --preset release \
    && cmake --build --preset release -j "$jobs" --target headers_alone
}

# The preset clang compiles each source by itself.
check_tidy() {
  if ((long)); then
    scripts/tidy.py --jobs "$jobs" --all build/release
  elif [[ -z $since ]]; then
    echo "summary: NOT RUN: no earlier commit is known; name one with --since REV"
  else
    scripts/tidy.py --jobs "$jobs" --since "$since" build/clang
  fi
}

build_and_test_changed_under_asan() {
  local plugins=
  [[ -z $since ]] || plugins=$(changed_plugins "$since" | paste -sd ';')
  echo "compiled for the preset asan: the framework, the program${plugins:+, ${plugins//;/, }}"
  build_and_test asan -DWEFT_PLAIN_PLUGINS="$PWD/build/release/lib/weft/plugins" \
    -DWEFT_CHECKED_PLUGINS="$plugins"
}

# Line coverage of what is installed, tests not counted. Plugins built elsewhere, as tests do,
# would have to be linked for coverage too; files that may not grow, as in another test, would cut off the
# counters.
measure_coverage() {
  (cd build/coverage && find . -name '*.gcda' -delete) \
    && ctest --preset coverage -L '^quick$' -E '^(out_of_tree|scaffold_quick|lost_output)_test$' -j "$jobs" --no-tests=error \
    && gcovr -j "$jobs" --root . --object-directory build/coverage --filter 'framework/' \
      --filter 'plugins/' --exclude '.*/tests/.*' --exclude 'framework/.*/testing/.*' \
      --exclude-unreachable-branches --exclude-throw-branches \
      --html-details build/coverage/coverage.html --txt build/coverage/coverage.txt
}

run_benchmarks() {
  cmake --build --preset release -j "$jobs" --target stages_benchmark host_benchmark \
    && build/release/bin/host_benchmark --benchmark_out=build/host_benchmark.json \
      --benchmark_out_format=json \
    && WEFT_PLUGIN_PATH="$PWD/build/release/lib/weft/plugins" build/release/bin/stages_benchmark \
      --benchmark_out=build/benchmarks.json --benchmark_out_format=json
}

report_coverage() {
  build coverage || return 0
  if step "coverage tests" build/coverage/coverage.log measure_coverage; then
    covered=$(grep '^TOTAL' build/coverage/coverage.txt | awk '{print $4 " of " $2 " lines"}')
  fi
}

what="quick tests"
((ci == 0)) || what="quick tests, AddressSanitizer for what changed, checks"
((long == 0)) || what="quick and long tests, AddressSanitizer, ThreadSanitizer, clang-tidy"
echo "Weft: $what, $jobs jobs, data: ${WEFT_DATA:-none}"
step bootstrap build/bootstrap.log scripts/bootstrap.sh --tests "${packages[@]}" || exit 1
if ((ci)); then
  [[ -n $since ]] || since=$(base_commit)
  step clang-format build/format.log check_format || true
fi
build_and_test release
if ((ci)); then
  step headers build/headers.log check_headers || true
  build clang || true
  step clang-tidy build/tidy.log check_tidy || true
  build_and_test_changed_under_asan
fi
if ((long)); then
  build_and_test asan -DWEFT_PLAIN_PLUGINS=
  step clang-tidy build/tidy.log check_tidy || true
  build_and_test tsan
  step fuzz build/fuzz.log scripts/fuzz.py --seconds 60 || true
  step benchmarks build/benchmarks.log run_benchmarks || true
fi
((coverage == 0)) || report_coverage

echo
echo "Summary"
printf '  %s\n' "${summary[@]}"
if [[ -n $covered ]]; then
  echo "Line coverage by the quick tests: $covered; build/coverage/coverage.html"
fi
if ((${#skipped[@]})); then
  echo "Skipped tests"
  printf '  %s\n' "${skipped[@]}"
else
  echo "No test was skipped."
fi
if ((failures)); then
  echo "Failed steps: $failures, after $((SECONDS / 60)) min $((SECONDS % 60)) s."
  exit 1
fi
echo "All passed in $((SECONDS / 60)) min $((SECONDS % 60)) s."

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds and tests the repository on a fresh Debian 12; see --help.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/common.sh
source scripts/common.sh

usage() {
  cat <<'TEXT'
usage: scripts/test.sh [--ci [--since REV] | --long [--all]] [--coverage] [--with-slurm] [--jobs N] [--without-...]

Installs missing packages, builds the preset release and runs its tests labelled `quick`. Exits 1 if
anything failed.

  --ci      the preset asan in place of release, and: clang-format over all tracked sources, each
            installed header compiled alone by GCC and by Clang and abi.h as C99, clang-tidy over
            what changed
  --since REV
            what changed since REV (default: since the branch left main, on main since the commit
            before); scripts/tidy.py says more
  --long    release, and what is run neither without options nor by --ci: the tests labelled `long` in the
            presets release and asan, the quick tests in the preset tsan (of plugins, those that start
            threads), clang-tidy over everything, each fuzzer of tests/fuzz for a minute, and the
            benchmarks of the stages and of the host (build/benchmarks.log). What the preset tsan and
            clang-tidy passed before and is unchanged since is skipped, and so is each test that passed
            before on the very same sources: a run that was stopped, or failed by the machine, goes on
  --ci --long
            all of both
  --all     with --long: skip nothing; tests of asan look for locals that are used after their
            function has returned, too, which takes twice the time
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
all=0
coverage=0
since=
packages=()
jobs=$(weft_jobs)
while (($#)); do
  case $1 in
    --ci) ci=1 ;;
    --long) long=1 ;;
    --all) all=1 ;;
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
((long || all == 0)) || refuse "--all goes with --long"
[[ -z $since ]] || ((ci && long == 0)) || refuse "--since goes with --ci"

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
# line of the log may tell more of what succeeded: `summary: RESULT: DETAIL`.
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

# build PRESET [TARGET]
build() {
  local preset=$1
  step "$preset configure" "build/$preset/configure.log" cmake --preset "$preset" \
    && step "$preset build" "build/$preset/build.log" \
      cmake --build --preset "$preset" -j "$jobs" ${2:+--target "$2"}
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

# ctest_due PRESET TESTS LABEL NONE STEP LOG: the tests of a test preset that have not passed on these
# sources. Their hashes stand beside the log, so that what passed before a run was stopped counts.
ctest_due() {
  local preset=$1 tests=$2 label=$3 none=$4 of=$5 log=$6 suite=$2-$3 passed=() status=0
  scripts/green.py tests "$of" "$log.sources" "$suite" "$log"
  scripts/green.py each "$of" "build/$preset" >"$log.sources"
  ((all)) || mapfile -t passed < <(scripts/green.py passed "$of" "$log.sources" "$suite")
  local skip=()
  if ((${#passed[@]})); then
    skip=(-E "^($(IFS='|' && echo "${passed[*]}"))\$")
    none=ignore
  fi
  # CTest itself writes a log when it has ended, and none when it is ended.
  ctest --preset "$tests" -L "^$label\$" "${skip[@]}" -j "$jobs" --no-tests="$none" \
    | tee "$log" || status=$?
  scripts/green.py tests "$of" "$log.sources" "$suite" "$log"
  if ((status == 0 && ${#passed[@]})); then
    local result
    result=$(grep -oE '[0-9]+% tests passed.*' "$log" | tail -n 1 || true)
    echo "summary: ok: ${result:-none was due}; ${#passed[@]} passed before on the same sources"
  fi
  return "$status"
}

run_tests() {
  local preset=$1 label=$2 none=$3 status=0 log=build/$1/test-$2.log
  if ((long)); then
    local tests=$preset of=tests
    [[ $preset != asan ]] || ((all == 0)) || tests=asan-stack
    [[ $preset != tsan ]] || of=tsan
    step "$preset $label" "$log" \
      ctest_due "$preset" "$tests" "$label" "$none" "$of" "build/$preset/ctest-$label.log" || status=1
  else
    step "$preset $label" "$log" \
      ctest --preset "$preset" -L "^$label\$" -j "$jobs" --no-tests="$none" || status=1
  fi
  collect_skipped "$preset" "test-$label"
  return "$status"
}

build_and_test() {
  local preset=$1
  if ! build "$preset"; then
    note "NOT RUN" 0 "$preset tests"
    return 0
  fi
  run_tests "$preset" quick error || true
  if ((long)) && [[ $preset != tsan ]]; then
    run_tests "$preset" long ignore || true
  fi
}

check_format() {
  git rev-parse --is-inside-work-tree >/dev/null \
    && git ls-files -z -- '*.h' '*.hpp' '*.c' '*.cpp' | xargs -0 -r clang-format --dry-run --Werror
}

check_headers() {
  cmake --preset release \
    && cmake --build --preset release -j "$jobs" --target headers_alone
}

check_tidy() {
  local which=()
  if ((long == 0)); then
    which=(--changed ${since:+--since "$since"} build/asan)
  elif ((all)); then
    which=(--all)
  fi
  scripts/tidy.py --jobs "$jobs" "${which[@]}"
}

# AddressSanitizer where its quick tests are left to --ci.
build_and_test_long_asan() {
  if build asan weft_long_tests; then
    run_tests asan long error || true
  else
    note "NOT RUN" 0 "asan tests"
  fi
}

# ThreadSanitizer, unless all that is behind it has passed before.
build_and_test_tsan() {
  local sources passed detail before=$failures
  sources=$(scripts/green.py sources tsan) || sources=
  if ((all == 0)) && passed=$(scripts/green.py since tsan "$sources"); then
    detail="unchanged since its green run of $passed, sources ${sources:0:12}"
    printf '%-16s ... skipped, %s\n' tsan "$detail"
    note skipped 0 tsan "$detail"
    return 0
  fi
  printf '%-16s ... due, sources %s\n' tsan "${sources:0:12}"
  build_and_test tsan
  if [[ -n $sources ]] && ((failures == before)); then
    scripts/green.py record tsan "$sources"
  fi
}

# Line coverage of what is installed, tests not counted. Plugins built elsewhere, as tests do,
# would have to be linked for coverage too; files that may not grow, as in another test, would cut off the
# counters.
measure_coverage() {
  (cd build/coverage && find . -name '*.gcda' -delete) \
    && ctest --preset coverage -L '^quick$' -E '^(out_of_tree|scaffold_quick|lost_output)_test$' -j "$jobs" --no-tests=error \
    && gcovr -j "$jobs" --root . --object-directory build/coverage --filter 'framework/' \
      --filter 'cli/' --filter 'plugins/' --exclude '.*/tests/.*' --exclude 'framework/.*/testing/.*' \
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
((ci == 0)) || what="quick tests under AddressSanitizer, checks"
((long == 0)) || what="quick and long tests, ThreadSanitizer, clang-tidy"
echo "Weft: $what, $jobs jobs, data: ${WEFT_DATA:-none}"
step bootstrap build/bootstrap.log scripts/bootstrap.sh --tests "${packages[@]}" || exit 1
((ci && long == 0)) || build_and_test release
if ((ci)); then
  build_and_test asan
  step clang-format build/format.log check_format || true
  step headers build/headers.log check_headers || true
  build clang || true
elif ((long)); then
  build_and_test_long_asan
fi
if ((ci || long)); then
  step clang-tidy build/tidy.log check_tidy || true
fi
if ((long)); then
  build_and_test_tsan
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

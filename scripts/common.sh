# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced by test.sh and demo.sh, which run in the repository root.

# The packages of bootstrap.sh are Debian's. pyenv, conda and the like put a python3 without NumPy,
# and libraries that CMake derives from PATH, before them.
export PATH=/usr/bin:$PATH
unset PYTHONHOME PYTHONPATH

# Jobs that the machine bears: one more than its cores, but 3 GiB of memory for each.
weft_jobs() {
  local kib limit by_cores by_memory
  kib=$(awk '/^MemTotal:/ {print $2}' /proc/meminfo)
  limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || echo max)
  if [[ $limit =~ ^[0-9]+$ ]] && ((limit / 1024 < kib)); then
    kib=$((limit / 1024))
  fi
  by_cores=$(($(nproc) + 1))
  by_memory=$((kib / 1024 / 1024 / 3))
  ((by_memory >= 1)) || by_memory=1
  echo $((by_memory < by_cores ? by_memory : by_cores))
}

# weft_logged LOG COMMAND...: runs it quietly; where it fails, shows what matters of the log.
weft_logged() {
  local log=$1
  shift
  mkdir -p "$(dirname "$log")"
  if "$@" >"$log" 2>&1; then
    return 0
  fi
  local telling='error:|Error|FAILED:|: Failure$|\*\*\*(Failed|Exception|Timeout)|SUMMARY: .*Sanitizer'
  echo "FAILED"
  grep -nE -m 20 "$telling" "$log" | cut -c 1-200 | sed 's/^/  /' || true
  echo "  ---- the end of $log"
  tail -n 40 "$log" | cut -c 1-200 | sed 's/^/  /'
  return 1
}

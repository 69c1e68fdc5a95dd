#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_large_files.sh FILE...: refuses files over 500 kB; data sets are described, never committed.
set -euo pipefail

status=0
for file in "$@"; do
  bytes=$(stat -c %s -- "$file")
  if ((bytes > 500000)); then
    echo "$file: $((bytes / 1000)) kB; describe data in pipelines/datasets instead of committing it"
    status=1
  fi
done
exit "$status"

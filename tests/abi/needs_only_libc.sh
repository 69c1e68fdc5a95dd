#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/abi/needs_only_libc.sh PROGRAM
#
# Fails if a program needs a shared library other than those of glibc: it might not start on a later
# system.
set -eu
others=$(readelf --dynamic "$1" | sed -n 's/.*Shared library: \[\(.*\)\]/\1/p' |
  grep -vE '^(libc|libm|libdl|libpthread|ld-linux-x86-64)\.so\.[0-9]+$' || true)
test -z "$others" || { printf "%s needs:\n%s\n" "$1" "$others" >&2; exit 1; }

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the site of the documentation and checks its links; see --help.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/common.sh

usage() {
  cat <<'TEXT'
usage: scripts/docs.sh [--out DIR] [--serve]

  --out DIR  folder of the site, default build/docs; DIR-source has the pages that mkdocs reads
  --serve    then serves it on http://localhost:8000
TEXT
}

out=build/docs
serve=
while (($#)); do
  case $1 in
    --out) out=${2:?docs.sh: --out needs a folder}; shift ;;
    --serve) serve=1 ;;
    -h | --help) usage; exit 0 ;;
    *) echo "docs.sh: unknown argument '$1'; see --help" >&2; exit 2 ;;
  esac
  shift
done
command -v mkdocs >/dev/null || {
  echo "docs.sh: mkdocs is missing; install the packages with scripts/bootstrap.sh --docs" >&2
  exit 1
}

python3 scripts/site/build.py . "$out"
python3 scripts/site/check_links.py "$out"
echo "Site: $out/index.html"
if [[ $serve ]]; then
  exec python3 -m http.server --bind localhost --directory "$out" 8000
fi

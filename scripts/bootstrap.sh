#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the Debian 12 packages that Weft needs and that are missing. Both demo.sh and test.sh call it.
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache git binutils pkg-config
  libgtest-dev libgmock-dev libbenchmark-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-features2d-dev libopencv-flann-dev
  libopencv-contrib-dev
  libopencv-calib3d-dev libopencv-imgcodecs-dev libopencv-videoio-dev libopencv-video-dev
  libeigen3-dev libboost-dev libboost-filesystem-dev libyaml-cpp-dev libcgal-dev
  libcli11-dev libfmt-dev nlohmann-json3-dev libxxhash-dev libzip-dev libcairo2-dev
  clang-format clang-tidy gcovr python3
)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || {
    echo "bootstrap.sh: install these packages as root first: ${missing[*]}" >&2
    exit 1
  }
  as_root=(sudo)
fi
echo "Installing ${#missing[@]} packages: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null

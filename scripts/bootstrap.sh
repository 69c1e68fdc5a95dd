#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the Debian 12 packages that Weft needs and that are missing, and builds the scripts of
# reports and of the live page with npm; see --help. demo.sh calls it, and test.sh with --tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
  cat <<'TEXT'
usage: scripts/bootstrap.sh [--tests] [--docs] [--with-slurm] [--without-contrib] [--without-opencl | --without-pocl]

  --tests            also what tests need: abidiff, clang with libFuzzer, libc++, clang-format,
                     clang-tidy, codespell, gcovr, chromium, jsonschema, matplotlib, mypy, NumPy,
                     OpenCV, PyTorch, websockets, xxhash and YAML for Python
  --docs             also what scripts/docs.sh needs: mkdocs with its theme, MathJax and Doxygen
  --with-slurm       also Slurm and MUNGE, for tests of ablations on a cluster
  --without-contrib  not libopencv-contrib-dev (148 MB, and VTK): templates/frex_sheet,
                     sources/frex_video and `weft calibrate` are then left out of the build
  --without-opencl   neither OpenCL nor pocl: detectors/sift_gpu and matchers/gpu are left out
  --without-pocl     not pocl (190 MB), OpenCL on the processor: for machines whose OpenCL devices
                     have drivers of their own
TEXT
}

packages=(
  g++ cmake ninja-build ccache git binutils pkg-config
  libgtest-dev libgmock-dev libbenchmark-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-features2d-dev libopencv-flann-dev
  libopencv-calib3d-dev libopencv-imgcodecs-dev libopencv-videoio-dev libopencv-video-dev
  libopencv-dnn-dev libavformat-dev
  libeigen3-dev libboost-dev libboost-filesystem-dev libyaml-cpp-dev libcgal-dev
  libembree-dev libceres-dev libhwy-dev libcli11-dev libfmt-dev nlohmann-json3-dev libtinygltf-dev
  libxxhash-dev libzip-dev libminizip-dev libsqlite3-dev libjpeg-dev libpng-dev zlib1g-dev
  python3 python3-dev python3-numpy pybind11-dev
)
contrib=(libopencv-contrib-dev)
opencl=(ocl-icd-opencl-dev opencl-headers opencl-clhpp-headers)
pocl=(pocl-opencl-icd)
tests=()
docs=()
slurm=()
for argument in "$@"; do
  case $argument in
    --tests) tests=(abigail-tools clang libclang-rt-dev clang-format clang-tidy codespell gcovr
      chromium libc++-dev libc++abi-dev python3-ipykernel python3-jsonschema python3-matplotlib
      python3-mypy python3-nbclient python3-numpy python3-opencv python3-torch python3-websockets python3-xxhash python3-yaml) ;;
    --docs) docs=(doxygen libjs-mathjax mkdocs mkdocs-material python3-pymdownx) ;;
    --with-slurm) slurm=(slurm-wlm munge) ;;
    --without-contrib) contrib=() ;;
    --without-opencl) opencl=() pocl=() ;;
    --without-pocl) pocl=() ;;
    -h | --help) usage; exit 0 ;;
    *) echo "bootstrap.sh: unknown argument '$argument'; see --help" >&2; exit 2 ;;
  esac
done
packages+=("${contrib[@]}" "${opencl[@]}" "${pocl[@]}" "${tests[@]}" "${docs[@]}" "${slurm[@]}")

# npm comes with Node where that is not Debian's.
command -v npm >/dev/null || packages+=(npm)

install_packages() {
  local package missing=() as_root=()
  for package in "${packages[@]}"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
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
}

# The scripts of reports and of the live page, from the packages that framework/web/package-lock.json fixes.
# Without a registry reports have tables only, and there is no live page; both report it.
build_scripts() {
  local inputs
  inputs=$(cat framework/web/package-lock.json framework/web/build.mjs $(find framework/web/src -type f | LC_ALL=C sort) | sha256sum)
  if [[ -f framework/web/dist/report.js && -f framework/web/dist/live.js && $(cat framework/web/dist/inputs 2>/dev/null) == "$inputs" ]]; then
    return 0
  fi
  echo "Building the scripts of reports and live page with npm"
  if npm --prefix framework/web ci --no-audit --no-fund --loglevel=error && npm --prefix framework/web run --silent build; then
    echo "$inputs" >framework/web/dist/inputs
  else
    echo "bootstrap.sh: npm could not build framework/web/dist: reports will have tables only, and there will be no live page" >&2
  fi
}

install_packages
build_scripts

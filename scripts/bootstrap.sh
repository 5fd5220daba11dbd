#!/usr/bin/env bash
# Installs what OracleGS is built from, on Debian 12 (bookworm). Does nothing when all of it is there.
set -euo pipefail

packages=(
  # tools
  build-essential cmake ninja-build ccache pkg-config git clang-format python3
  # tensors; OpenBLAS because libtorch multiplies matrices four times slower with the reference BLAS
  libtorch-dev libopenblas0-pthread libhwy-dev libeigen3-dev
  # files, command line, log
  nlohmann-json3-dev libcli11-dev libspdlog-dev libfmt-dev
  libturbojpeg0-dev libpng-dev zlib1g-dev libsqlite3-dev libcurl4-openssl-dev libcairo2-dev
  # tests and benchmarks
  libgtest-dev libgmock-dev libbenchmark-dev
  # run as child processes
  colmap ffmpeg
)

# for examples/generators; Node.js from elsewhere brings an npm that Debian's would replace
command -v npm >/dev/null || packages+=(nodejs npm)

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  {
    echo "scripts/bootstrap.sh: this is not a Debian system. Install the equivalents of these Debian 12 packages:"
    printf '  %s\n' "${packages[@]}"
    echo "then build with: cmake --preset release && cmake --build --preset release"
  } >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "scripts/bootstrap.sh: run as root, or install sudo; missing packages: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "Installing: ${missing[*]}"
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q)
"${apt[@]}" update </dev/null
"${apt[@]}" install -y --no-install-recommends "${missing[@]}" </dev/null

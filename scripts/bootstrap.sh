#!/usr/bin/env bash
# Installs what OracleGS is built from, on Debian 12 (bookworm), and the npm packages of its web pages. Does nothing when all
# of it is there.
#   scripts/bootstrap.sh --libraries   only lists the packages that every build links to
set -euo pipefail
cd "$(dirname "$0")/.."

libraries=(
  # numbers
  libhwy-dev libeigen3-dev
  # files, command line, log
  nlohmann-json3-dev libcli11-dev libspdlog-dev libfmt-dev
  libturbojpeg0-dev libpng-dev zlib1g-dev libsqlite3-dev libcurl4-openssl-dev libcairo2-dev libwebp-dev libzip-dev libzstd-dev
  libheif-dev libtiff-dev libmeshoptimizer-dev libpugixml-dev
  libcpp-httplib-dev
  # tests and benchmarks
  libgtest-dev libgmock-dev libbenchmark-dev
)
if [[ ${1:-} == --libraries ]]; then
  printf '%s\n' "${libraries[@]}"
  exit
fi

packages=(
  # tools
  build-essential cmake ninja-build ccache pkg-config git clang-format python3
  "${libraries[@]}"
  # networks; OpenBLAS because libtorch multiplies matrices four times slower with the reference BLAS
  libtorch-dev libopenblas0-pthread
  # meshes; Boost's headers because OpenVDB's include them and its package does not ask for them
  libopenvdb-dev libboost-dev
  # the Python package
  pybind11-dev python3-dev python3-numpy
  # photos of tests
  libheif-examples
  # sanitizers and fuzzers
  clang clang-tidy libclang-rt-14-dev llvm lld
  # run as child processes
  colmap ffmpeg
  # tests of the web pages
  chromium
)

# for web/ and examples/generators; Node.js from elsewhere brings an npm that Debian's would replace
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
if ((${#missing[@]} > 0)); then
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
fi

# Where everything is tested, also a Slurm of one machine; its services are nothing for a laptop, and its test is skipped
# without it.
if [[ -n ${CI:-} ]] && ! command -v sbatch >/dev/null; then
  as_root=()
  ((EUID == 0)) || as_root=(sudo)
  apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q)
  { "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends slurm-wlm munge; } </dev/null ||
    echo "scripts/bootstrap.sh: no Slurm; the test of its launcher will be skipped" >&2
fi

# The packages that the viewer and the report are bundled from; npm writes the list of what it has installed.
if ! [[ web/node_modules/.package-lock.json -nt web/package-lock.json ]]; then
  echo "Installing the npm packages of web/"
  npm ci --prefix web --no-audit --no-fund --ignore-scripts </dev/null || {
    rm -rf web/node_modules
    echo "scripts/bootstrap.sh: npm cannot install the packages of web/; it needs registry.npmjs.org, or npm config set registry." >&2
    echo "Everything but the viewer and the report is built without them." >&2
  }
fi

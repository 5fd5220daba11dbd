#!/usr/bin/env bash
# Installs what is missing, builds, checks the format and the house rules, runs every test.
#   scripts/test.sh                  what a change has to pass
#   scripts/test.sh -R render        arguments go to ctest
#   scripts/test.sh --all            what CI runs: then also sanitizers, fuzzers, clang-tidy, and the device code compiled
#                                    with nvcc where there is one
# CI=true: plain output, warnings are errors, and what does not fit into 45 minutes is left out, which is said.
set -euo pipefail
cd "$(dirname "$0")/.."

all=
if [[ ${1:-} == --all ]]; then
  all=yes
  shift
fi
configure=()
if [[ ${CI:-} == true ]]; then
  configure+=(-DORACLEGS_WERROR=ON)
  export CLICOLOR=0 GTEST_COLOR=no GTEST_BRIEF=1
fi
PATH=$PATH:/usr/local/cuda/bin

step() { echo "== $1 ($((SECONDS / 60)):$(printf %02d $((SECONDS % 60))))"; }

# within MINUTES PRESET: whether that much has not passed yet; CI stops after 45 minutes, a person waits.
left_out=
within() {
  [[ ${CI:-} != true ]] || ((SECONDS < 60 * $1)) || {
    left_out+="${left_out:+, }$2"
    return 1
  }
}

# run PRESET CTEST_ARGUMENTS...: configures, builds, tests.
run() {
  local preset=$1
  shift
  step "preset $preset"
  cmake --preset "$preset" "${configure[@]}" >/dev/null
  cmake --build --preset "$preset" --parallel "$(nproc)"
  ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error "$@"
}

# check PRESET SUITE...: the same of some test programs alone.
check() {
  local preset=$1
  shift
  step "preset $preset"
  cmake --preset "$preset" "${configure[@]}" >/dev/null
  cmake --build --preset "$preset" --parallel "$(nproc)" --target "${@/%/_tests}"
  ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error -R "^($(IFS='|'; echo "$*"))\$"
}

# Folders with npm packages that tests run; npm writes the list of what it has installed.
npm_folders=(examples/generators/inpaint_holes tests/foreign)
install_npm_packages() {
  local folder
  for folder in "${npm_folders[@]}"; do
    [[ $folder/node_modules/.package-lock.json -nt $folder/package-lock.json ]] && continue
    step "npm packages of $folder"
    npm ci --prefix "$folder" --no-audit --no-fund || {
      echo "scripts/test.sh: npm cannot install the packages of $folder; it needs registry.npmjs.org, or npm config set registry" >&2
      exit 1
    }
  done
}

scripts/bootstrap.sh
install_npm_packages
scripts/format.sh --check
python3 scripts/check_house_test.py --quiet
cmake --preset release "${configure[@]}" >/dev/null
python3 scripts/check_house.py
run release "$@"
[[ -n $all ]] || exit 0

# The floors below settings, where the parsers and the kernels are.
floors=(core image camera scene sfm demo depth gaussians formats render loss train propose weights web mesh)
threaded=(core depth render loss train propose web)
if within 20 asan; then
  check asan "${floors[@]}" cuda
  step "fuzzers"
  scripts/fuzz.sh --seed 1
fi
if within 32 tsan; then check tsan "${threaded[@]}"; fi
if within 36 tidy; then
  step "clang-tidy"
  scripts/tidy.sh
fi
if command -v nvcc >/dev/null && within 39 cuda; then  # for a real device; running it needs a GPU
  step "preset cuda"
  cmake --preset cuda -DORACLEGS_APPS=OFF -DCMAKE_CUDA_ARCHITECTURES=90 "${configure[@]}" >/dev/null
  cmake --build --preset cuda --parallel "$(nproc)" --target cuda_tests gpu_bench
  build/cuda/bin/cuda_tests --gtest_brief=1 | tail -n 3
  python3 scripts/device_code.py --check
fi
step "passed${left_out:+, without $left_out}"

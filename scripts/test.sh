#!/usr/bin/env bash
# Installs what is missing, builds, checks the format and the house rules, runs every test; then the same of the engine with
# sanitizers and without optimisation, and compiles the device code with nvcc where there is one.
#   scripts/test.sh                  everything
#   scripts/test.sh -R render        the optimised build alone; arguments go to ctest
# ORACLEGS_NVCC=0 leaves nvcc out, ORACLEGS_NVCC=1 fails without one. CI=true: plain output, warnings are errors, and a later
# part is left out, with a line that says so, where it could not end in time (an empty compiler cache on two cores).
set -euo pipefail
cd "$(dirname "$0")/.."

configure=()
if [[ ${CI:-} == true ]]; then
  configure+=(-DORACLEGS_WERROR=ON)
  export CLICOLOR=0 GTEST_COLOR=no GTEST_BRIEF=1
fi
PATH=$PATH:/usr/local/cuda/bin

step() { echo "== $1 ($((SECONDS / 60)):$(printf %02d $((SECONDS % 60))))"; }

# run PRESET CTEST_ARGUMENTS...: configures, builds, tests.
run() {
  local preset=$1
  shift
  step "preset $preset"
  cmake --preset "$preset" "${configure[@]}" >/dev/null
  cmake --build --preset "$preset" --parallel "$(nproc)"
  ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error "$@"
}

scripts/bootstrap.sh
scripts/format.sh --check
python3 scripts/check_house_test.py --quiet
cmake --preset release "${configure[@]}" >/dev/null
python3 scripts/check_house.py
run release "$@"
(($# == 0)) || exit 0

# in_time MINUTES PART: false when CI has passed so many minutes already.
in_time() {
  [[ ${CI:-} == true ]] && ((SECONDS > 60 * $1)) || return 0
  echo "== left out: $2 ($((SECONDS / 60)) minutes have passed)"
  return 1
}

if in_time 25 asan; then run asan; fi
if in_time 32 debug; then run debug; fi
if in_time 38 cuda && [[ ${ORACLEGS_NVCC:-} != 0 ]] && { [[ ${ORACLEGS_NVCC:-} == 1 ]] || command -v nvcc >/dev/null; }; then
  step "preset cuda"  # for a real device; running it needs a GPU
  cmake --preset cuda -DORACLEGS_NETWORKS=OFF -DCMAKE_CUDA_ARCHITECTURES=90 "${configure[@]}" >/dev/null
  cmake --build --preset cuda --parallel "$(nproc)" --target cuda_tests gpu_bench
  build/cuda/bin/cuda_tests --gtest_brief=1 | tail -n 3
fi
step "all passed"

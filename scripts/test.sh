#!/usr/bin/env bash
# Installs what is missing, builds, checks the format and the house rules, runs every test. Arguments go to ctest, e.g.
#   scripts/test.sh -R core
# With ORACLEGS_NVCC=1 nvcc compiles and links the device code, too, which else is compiled for the emulated device only.
# With CI=true the output is plain and warnings are errors whatever the build folder was configured with before.
set -euo pipefail
cd "$(dirname "$0")/.."

configure=()
if [[ ${CI:-} == true ]]; then
  configure+=(-DORACLEGS_WERROR=ON)
  export CLICOLOR=0 GTEST_COLOR=no GTEST_BRIEF=1
fi

scripts/bootstrap.sh
scripts/format.sh --check
python3 scripts/check_house_test.py --quiet
python3 scripts/check_house.py
cmake --preset release "${configure[@]}"
cmake --build --preset release --parallel "$(nproc)"
if [[ ${ORACLEGS_NVCC:-} == 1 ]]; then  # device code for a real device, too; running it needs a GPU
  cmake --preset cuda -DCMAKE_CUDA_ARCHITECTURES=90 >/dev/null
  cmake --build --preset cuda --parallel "$(nproc)" --target cuda_tests
  build/cuda/bin/cuda_tests --gtest_brief=1
fi
exec ctest --preset release --parallel "$(nproc)" --no-tests=error "$@"

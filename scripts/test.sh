#!/usr/bin/env bash
# Installs what is missing, builds, checks the format and the house rules, runs every test. Arguments go to ctest, e.g.
#   scripts/test.sh -R core
# With CI=true the output is plain, warnings are errors whatever the build folder was configured with before, and nvcc, where
# there is one, compiles and links the device code, too, which else is compiled for the emulated device only. It is left out when
# all before took a quarter of an hour (an empty compiler cache), since CI has 25 minutes. ORACLEGS_NVCC=1: in any case, 0: never.
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
ctest --preset release --parallel "$(nproc)" --no-tests=error "$@"

wants_nvcc=${ORACLEGS_NVCC:-}
if [[ -z $wants_nvcc && ${CI:-} == true ]] && PATH=$PATH:/usr/local/cuda/bin command -v nvcc >/dev/null; then
  wants_nvcc=$((SECONDS < 900))
  ((wants_nvcc)) || echo "Device code is not compiled with nvcc: $((SECONDS / 60)) minutes have passed"
fi
if [[ $wants_nvcc == 1 ]]; then  # for a real device; running it needs a GPU
  cmake --preset cuda -DCMAKE_CUDA_ARCHITECTURES=90 "${configure[@]}" >/dev/null
  cmake --build --preset cuda --parallel "$(nproc)" --target cuda_tests
  build/cuda/bin/cuda_tests --gtest_brief=1 | tail -n 3
fi

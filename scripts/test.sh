#!/usr/bin/env bash
# Installs what is missing, builds, checks the format and the house rules, runs every test.
#   scripts/test.sh                        what a change has to pass: the stage release
#   scripts/test.sh -R render              arguments go to ctest
#   scripts/test.sh --all                  every stage but long
#   scripts/test.sh --all --minutes 75     what CI runs: begins no stage that would end later, and says which it leaves out
#   scripts/test.sh --stage asan --stage tidy    these stages:
#     release  builds and tests everything
#     asan     address and undefined-behavior sanitizers on the floors below settings; then each fuzzer for some seconds
#     cuda     compiles the device code with nvcc; running it needs a GPU
#     tidy     clang-tidy
#     tsan     the thread sanitizer on the floors with threads
#     dev      the floors of the engine, each file on its own and without precompiled headers
#     arm64    the program for 64-bit ARM, compiled alone: packaging/arm64.sh, which installs Debian's cross compiler
#     long     minutes a fuzzer, all tests of the preset dev, the growth of parsers; not in --all
# A stage that cannot run fails; --minutes alone leaves stages out. CI=true: plain output, warnings are errors.
set -euo pipefail
cd "$(dirname "$0")/.."

all_stages=(release asan cuda tidy tsan dev arm64)
stages=()
minutes=
while [[ ${1:-} == --all || ${1:-} == --stage || ${1:-} == --minutes ]]; do
  if [[ $1 == --all ]]; then
    stages=("${all_stages[@]}")
  elif [[ $1 == --minutes ]]; then
    [[ ${2:-} =~ ^[0-9]+$ ]] || {
      echo "scripts/test.sh: --minutes ${2:-}: give a number" >&2
      exit 2
    }
    minutes=$2
    shift
  else
    [[ " ${all_stages[*]} long " == *" ${2:-} "* && -n ${2:-} ]] || {
      echo "scripts/test.sh: --stage ${2:-}: give one of ${all_stages[*]} long" >&2
      exit 2
    }
    stages+=("$2")
    shift
  fi
  shift
done
((${#stages[@]} > 0)) || stages=(release)

configure=()
if [[ ${CI:-} == true ]]; then
  configure+=(-DORACLEGS_WERROR=ON)
  export CLICOLOR=0 GTEST_COLOR=no GTEST_BRIEF=1
fi
PATH=$PATH:/usr/local/cuda/bin

step() { echo "== $1 ($((SECONDS / 60)):$(printf %02d $((SECONDS % 60))))"; }

# build PRESET TARGET...: configures and builds; everything without a target.
build() {
  local preset=$1
  shift
  step "build $preset"
  cmake --preset "$preset" "${configure[@]}" >/dev/null
  cmake --build --preset "$preset" --parallel "$(nproc)" ${1:+--target} "$@"
}

# run_tests PRESET CTEST_ARGUMENTS...
run_tests() {
  local preset=$1
  shift
  step "test $preset"
  # Tests run side by side: OpenMP's threads that wait must leave the processor to others.
  OMP_WAIT_POLICY=passive ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error "$@"
}

# check PRESET SUITE...: builds and runs some test programs alone.
check() {
  local preset=$1
  shift
  build "$preset" "${@/%/_tests}"
  run_tests "$preset" -R "^($(IFS='|'; echo "$*"))\$"
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

stage_release() {
  install_npm_packages
  scripts/format.sh --check
  python3 scripts/check_house_test.py --quiet
  cmake --preset release "${configure[@]}" >/dev/null
  python3 scripts/check_house.py
  build release
  run_tests release "$@"
}

# The floors below settings, where the parsers and the kernels are.
floors=(core image camera scene capture sfm demo depth gaussians formats datasets render loss train propose weights web app mesh)
stage_asan() {
  check asan "${floors[@]}" cuda
  step "fuzzers"
  scripts/fuzz.sh --seed 1 --seconds 8
}

stage_tsan() { check tsan core depth render loss train propose web app; }

stage_tidy() {
  step "clang-tidy"
  scripts/tidy.sh
}

stage_dev() {
  local engine=(core image camera scene depth gaussians formats render loss train)
  step "build dev, each file on its own"
  cmake --preset dev -B build/alone -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_CXX_FLAGS_DEBUG=-O0 "${configure[@]}" >/dev/null
  cmake --build build/alone --parallel "$(nproc)" --target "${engine[@]/#/oraclegs_}"
}

stage_arm64() {
  step "build arm64"
  packaging/arm64.sh --build
}

stage_cuda() {
  command -v nvcc >/dev/null || {
    echo "scripts/test.sh: the stage cuda needs nvcc, of the CUDA toolkit 12 or later; --stage names the others" >&2
    exit 1
  }
  local configure=("${configure[@]}" -DORACLEGS_APPS=OFF -DCMAKE_CUDA_ARCHITECTURES=90)
  build cuda cuda_tests cuda_library_tests gpu_bench
  for tests in cuda_tests cuda_library_tests; do build/cuda/bin/$tests --gtest_brief=1 | tail -n 3; done
  python3 scripts/device_code.py --check
}

stage_long() {
  step "fuzzers"
  scripts/fuzz.sh --seconds 300
  build dev
  run_tests dev
  build release parser_growth_bench
  build/release/bin/parser_growth_bench
}

# What a stage takes, in percent of what release took.
declare -A share=([asan]=135 [cuda]=15 [tidy]=35 [tsan]=35 [dev]=35 [arm64]=35)

scripts/bootstrap.sh
passed=() left_out=() release_seconds=0
for stage in "${stages[@]}"; do
  if [[ -n $minutes ]] && ((SECONDS + release_seconds * ${share[$stage]:-0} / 100 >= 60 * minutes)); then
    left_out+=("$stage")
    continue
  fi
  "stage_$stage" "$@"
  [[ $stage != release ]] || release_seconds=$SECONDS
  passed+=("$stage")
done
step "passed ${passed[*]}"
((${#left_out[@]} == 0)) || step "left out, for $minutes minutes: ${left_out[*]}"

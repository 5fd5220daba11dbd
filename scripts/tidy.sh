#!/usr/bin/env bash
# Reads the library with clang-tidy (.clang-tidy says which checks) as the preset asan compiles it.
#   scripts/tidy.sh           all floors without libtorch
#   scripts/tidy.sh render    one
set -euo pipefail
cd "$(dirname "$0")/.."

build=build/asan
[[ -f $build/compile_commands.json ]] || cmake --preset asan >/dev/null
cmake --build --preset asan --target oraclegs_pch >/dev/null  # clang-tidy reads the precompiled header

# Files are read in the same groups in which they are compiled; the kernels of Highway stand alone and are left out: each
# would be read once an instruction set.
groups=("$build"/src/CMakeFiles/oraclegs_${1:-*}.dir/Unity/unity_*.cxx)
printf '%s\0' "${groups[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy --quiet -p "$build" 2> >(grep -vE '^[0-9]+ warnings? generated|^$' >&2) || {
  echo "scripts/tidy.sh: clang-tidy has findings" >&2
  exit 1
}

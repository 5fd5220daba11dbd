#!/usr/bin/env bash
# Formats every C++ and CUDA file with clang-format. --check changes nothing and fails when a file would change.
set -euo pipefail
cd "$(dirname "$0")/.."

mode=(-i)
case "${1:-}" in
  "") ;;
  --check) mode=(--dry-run -Werror) ;;
  *) echo "usage: scripts/format.sh [--check]" >&2; exit 2 ;;
esac

folders=()
for folder in src apps tests bench cmake python; do
  [[ -d $folder ]] && folders+=("$folder")
done
# A newer clang-format breaks lines elsewhere: the version of Debian 12 decides where it is installed.
program=$(command -v clang-format-14 || command -v clang-format)
find "${folders[@]}" -type f \( -name '*.cpp' -o -name '*.h' -o -name '*.cu' -o -name '*.cuh' \) -print0 |
  xargs -0 -r -n 16 -P "$(nproc)" "$program" "${mode[@]}" || {
  echo "scripts/format.sh: not formatted as clang-format 14 does it; run scripts/format.sh" >&2
  exit 1
}

#!/usr/bin/env bash
# Runs the tampering benchmark on the measuring scenes (docs/method.md#tampering-benchmark) and prints their tables.
#   bench/tampering.sh DATA_FOLDER OUT_FOLDER [SEEDS] [EXTRA OPTIONS FOR EVERY RUN ...]
set -euo pipefail
if (($# < 2)); then
  sed -n 's/^# \{0,1\}//p' "$0" | sed -n 2,3p >&2
  exit 2
fi
here=$(cd "$(dirname "$0")/.." && pwd)
data=$1 out=$2 seeds=${3:-3}
shift $(($# < 3 ? $# : 3))

run() { # NAME OPTIONS...
  local name=$1
  shift
  echo "== $name"
  "$here/build/release/bin/oraclegs" ablate "$data/$name" -o "$out/$name" --suite tampering --seeds "$seeds" \
    --downscale 2 --iterations 7000 --max-gaussians 100000 "$@"
}
run fox --views 12 "$@"
run lego --background white "$@"
run sceaux --test-views 7103,7107 --exposure on "$@"

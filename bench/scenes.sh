#!/usr/bin/env bash
# Reconstructs the three measuring scenes by the project's protocol (docs/benchmarks.md) and prints one table.
#   bench/scenes.sh DATA_FOLDER OUT_FOLDER [SEED] [EXTRA OPTIONS FOR EVERY RUN ...]
set -euo pipefail
if (($# < 2)); then
  sed -n 's/^# \{0,1\}//p' "$0" | sed -n 2,3p >&2
  exit 2
fi
here=$(cd "$(dirname "$0")/.." && pwd)
data=$1 out=$2 seed=${3:-0}
shift $(($# < 3 ? $# : 3))

run() { # NAME OPTIONS...
  local name=$1
  shift
  "$here/build/release/bin/oraclegs" reconstruct "$data/$name" -o "$out/$name-$seed" --quiet \
    --downscale 2 --iterations 7000 --max-gaussians 100000 --seed "$seed" "$@"
}
run fox --eval --views 12 "$@"
run lego --background white "$@"
run sceaux --test-views 7103,7107 "$@"

python3 - "$out" "$seed" <<"TABLE"
import json, sys
out, seed = sys.argv[1:]
print(f"{'scene':8}{'PSNR':>8}{'SSIM':>8}{'PSNR cc':>9}{'Gaussians':>11}{'train s':>9}{'ms/it':>7}{'sfm s':>7}{'MiB':>7}")
for name in ("fox", "lego", "sceaux"):
    m = json.load(open(f"{out}/{name}-{seed}/metrics.json"))
    t, train, stages = m["test"], m["train"], m["stages"]
    print(f"{name:8}{t['psnr']:8.2f}{t['ssim']:8.4f}{t['psnr_color_corrected']:9.2f}{m['gaussians']:11d}"
          f"{train['iterations'] / train['iterations_per_second']:9.0f}{1000 / train['iterations_per_second']:7.1f}"
          f"{stages['sfm']['seconds']:7.0f}{m['peak_memory_bytes'] / 2**20:7.0f}")
TABLE

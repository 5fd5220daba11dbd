#!/usr/bin/env bash
# Measures the CPU figures of docs/benchmarks.md and docs/baselines.md and prints them as Markdown. All of them take a night
# on two cores, which must do nothing else. Build the preset release first. scripts/gpu_check.sh measures a GPU.
#   scripts/benchmarks.sh DATA OUT [SECTION ...]
# DATA     holds fox, lego and sceaux, and room and bonsai for growth; docs/benchmarks.md says where they come from
# OUT      receives the runs; a run that is finished there is kept
# SECTION  quality, predicted, methods, parts, confidence, tampering, depth, kinds, speed, growth, demo, support, files
#          or memory; all unless given. predicted, support, files and memory read the runs of quality
set -euo pipefail
if (($# < 2)); then
  sed -n 's/^# \{0,1\}//p' "$0" | sed -n 4,8p >&2
  exit 2
fi
here=$(cd "$(dirname "$0")/.." && pwd)
data=$(realpath -- "$1") out=$(realpath -m -- "$2")
shift 2
bin=$here/build/release/bin fox=$out/quality/fox-defaults-0
mkdir -p "$out"

# figures WORDS...: the tables that are made from files of finished runs
figures() {
  python3 - "$@" <<'PYTHON'
import json, sys
from pathlib import Path

what, *paths = sys.argv[1:]


def row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |")


def read(folder, name="metrics.json"):
    return json.loads((Path(folder) / name).read_text())


def clock(seconds):
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


if what == "predicted":
    row("run", "predicted", "real")
    row(*["---"] * 3)
    for folder in paths:
        timed = [record for record in read(folder, "stages.json").values() if "predicted_seconds" in record]
        times = [sum(record[key] for record in timed) for key in ("predicted_seconds", "seconds")]
        row(Path(folder).name, *map(clock, times))
elif what == "support":
    row("class", "share of the pixels", "mean error")
    row(*["---"] * 3)
    support = read(paths[0])["support"]
    for c in support["classes"]:
        row(c["name"], f"{100 * c['share']:.1f} %", f"{c['mean_error']:.3f}")
    sure = read(paths[0])["uncertainty"]["models"]
    print(f"\nUncertainty: AUROC for an error above 0.1 {sure['auroc_large_error']:.2f}, AUSE of random {sure['ause_ratio']:.2f}")
elif what == "files":
    row("file", "MB", "loss at the test views, dB")
    row(*["---"] * 3)
    whole = read(paths[0])["test"]["psnr"]
    for folder in paths[1:]:
        (file,) = Path(folder).glob("fox.*")
        loss = whole - read(Path(folder) / "scores")["test"]["psnr"]
        row(f"`{file.name.removeprefix('fox')}`", f"{file.stat().st_size / 1e6:.2f}", f"{loss:.2f}")
elif what == "memory":
    row("run", "peak, GB")
    row(*["---"] * 2)
    for folder in paths:
        row(Path(folder).name, f"{read(folder)['peak_memory_bytes'] / 1e9:.1f}")
elif what == "demo":
    test = read(paths[0])["test"]
    print(f"The demo: {test['psnr']:.2f} dB / {test['ssim']:.4f}\n")
PYTHON
}

quality() {
  "$here/bench/time_to_quality.py" "$data" "$out/quality" --scenes fox,lego,sceaux \
    --setting "defaults: --iterations 2500 --max-gaussians 100000" \
    --setting "photos alone: --iterations 2500 --max-gaussians 100000 --proposers none" \
    --setting "small, warps: --iterations 2600 --max-gaussians 30000 --proposers warp"
}

predicted() { figures predicted "$out"/quality/{fox,lego,sceaux}-defaults-0; }

methods() {
  local all=ours,ours-no-proposals,dropgaussian,cor-gs,fsgs,sparsegs,comapgs,dngaussian,3dgs-mcmc,3dgs,3dgs-mcmc-random
  "$here/bench/suite.py" "$data" "$out/methods" --scenes fox-12,lego-8,sceaux-9 --methods "$all" --options "--threads 1"
}

parts() {
  local scene options
  for scene in fox lego; do
    options=(--views 12)
    [[ $scene == fox ]] || options=(--background white)
    "$bin/oraclegs" ablate "$data/$scene" -o "$out/parts-$scene" --quiet --downscale 4 \
      --max-gaussians 30000 "${options[@]}" >&2
    printf '\n%s\n\n' "$scene"
    cat "$out/parts-$scene/ablation.md"
  done
}

confidence() {
  "$bin/oraclegs" reconstruct "$data/fox" -o "$out/confidence" --quiet --eval --views 12 --downscale 4 \
    --max-gaussians 50000 >&2
  "$bin/oraclegs" evaluate "$out/confidence" --check-oracle
}

tampering() {
  "$bin/oraclegs" ablate "$data/fox" -o "$out/tampering" --quiet --compare tampering --views 12 --downscale 4 \
    --max-gaussians 30000 >&2
  cat "$out/tampering/tampering.md"
}

depth() {
  local size
  for size in 320x240 480x360; do
    [[ -d $out/scene-$size ]] ||
      "$bin/oraclegs" demo-scene "$out/scene-$size" --quiet --width "${size%x*}" --height "${size#*x}" >&2
    "$bin/oraclegs" depth "$out/scene-$size" -o "$out/depth-$size" --quiet --eval --views 12 >&2
    printf '%s: ' "$size"
    "$bin/truth_bench" "$out/depth-$size" | tail -n 1
  done
}

kinds() { "$here/bench/kinds.py" "$out/kinds"; }

speed() { "$here/bench/stages.py" "$data" "$out/speed" --min-time 0.4; }

growth() { "$here/bench/growth.py" "$data" "$out/growth" --plot "$out/growth.svg"; }

demo() {
  "$bin/oraclegs" demo -o "$out/demo" --quiet >&2
  "$bin/oraclegs" mesh "$out/demo/run" --quiet -o "$out/demo/mesh.ply" >&2
  figures demo "$out/demo/run"
  "$bin/mesh_truth_bench" "$out/demo/mesh.ply"
}

support() { figures support "$fox"; }

files() {
  local type folders=()
  for type in ply glb compressed.ply splat spz spz.glb sog; do
    mkdir -p "$out/files/$type"
    "$bin/oraclegs" export "$fox" --quiet --scale 1 -o "$out/files/$type/fox.$type" >&2 || continue  # it says why
    folders+=("$out/files/$type")
    "$bin/oraclegs" export "$out/files/$type/fox.$type" --quiet -o "$out/files/$type/back.ply" >&2
    "$bin/oraclegs" evaluate "$fox" --ply "$out/files/$type/back.ply" -o "$out/files/$type/scores" --quiet >&2
  done
  figures files "$fox" "${folders[@]}"
}

memory() { figures memory "$out"/quality/{fox,lego,sceaux}-*-0; }

sections=(quality predicted methods parts confidence tampering depth kinds speed growth demo support files memory)
for section in "${@:-${sections[@]}}"; do
  [[ " ${sections[*]} " == *" $section "* ]] || { echo "scripts/benchmarks.sh: no section $section" >&2; exit 2; }
done
for section in "${@:-${sections[@]}}"; do
  printf '\n## %s\n\n' "$section"
  "$section"
done

#!/usr/bin/env bash
# Builds with CUDA and runs what needs a GPU. What is worth most comes first, and every step runs although others failed.
#   scripts/gpu_check.sh [--packages FILE] [--scene FILE.ply --views transforms.json] [--seconds N]
#   scripts/gpu_check.sh --gsplat PATH [--packages FILE] [--scene FILE.ply --views transforms.json] [--seconds N]
#   scripts/gpu_check.sh --networks [--packages FILE] [--seconds N]
# --packages  libraries that scripts/gpu_pack.sh packed, for a machine without them
# --scene     a trained model to measure beside the synthetic scene; its cameras. Without it the demo scene is trained for that
# --gsplat    only times gsplat, built from its source (with its submodules) at PATH, beside gpu_bench on the same scene
# --networks  only builds the networks with the PyTorch of python3, runs their tests and times Stable Virtual Camera and VGGT
# --seconds   the time for everything, 540 unless given
# Needs nvcc, CMake 3.25, Ninja, g++ and python3; nothing of Python but its standard library, and PyTorch for --networks. Logs
# and figures lie in build/gpu_check, and all together in $OUT/gpu_check.tar.gz where OUT names a folder, else in build/gpu_check.tar.gz.
# Exit code 0 when every step passed or was skipped and there is a GPU.
set -uo pipefail
usage() { sed -n '3,5s/^# */usage: /p' "$0" >&2; exit 2; }
packages='' scene='' views='' gsplat='' networks='' seconds=540
while (($#)); do
  [[ $1 != --networks ]] || { networks=yes; shift; continue; }
  (($# > 1)) || usage
  case "$1" in
    --packages) packages=$(realpath -- "$2") ;;
    --scene) scene=$(realpath -- "$2") ;;
    --views) views=$(realpath -- "$2") ;;
    --gsplat) gsplat=$(realpath -- "$2") ;;
    --seconds) seconds=$2 ;;
    *) usage ;;
  esac
  shift 2
done
[[ -n $scene && -n $views || -z $scene$views ]] || usage
[[ -z $networks || -z $gsplat$scene ]] || usage
cd "$(dirname "$0")/.." || exit 2
if [[ $scene == "$(realpath -m build/gpu_check)"/* || $views == "$(realpath -m build/gpu_check)"/* ]]; then
  echo "scripts/gpu_check.sh: $scene lies in build/gpu_check, which is emptied first: copy it and its views elsewhere" >&2
  exit 2
fi

deadline=$((SECONDS + seconds))
jobs=${ORACLEGS_JOBS:-$(nproc)}
tree=build/cuda${networks:+_networks}
export out=build/gpu_check bin=$tree/bin
mkdir -p build
archive=$(realpath -- "${OUT:-build}")/gpu_check.tar.gz
rm -rf "$out" && mkdir -p "$out/scene" "$out/tests"
failed=0

save() {
  (cd build && find gpu_check -type f '(' -name '*.log' -o -name '*.txt' -o -name '*.json' ')' -size -8M -print0) |
    tar czf "$archive" -C build --null -T -
}
row() { printf '%-22s %-8s %s\n' "$1" "$2" "$3" >> "$out/summary.txt"; }
skip() { row "$1" skipped "$2"; }
# fail NAME WHY
fail() { row "$1" FAILED "$2"; failed=1; }

finish() {
  figures
  printf '\n'
  cat "$out/summary.txt" "$out/figures.txt"
  save
  echo "all logs: $archive"
  exit $failed
}

# step NAME SECONDS COMMAND...: a program or a function. Its log is $out/NAME.log; of a failed one the errors are shown, or
# else the last lines.
step() {
  local name=$1 limit=$2 begin=$SECONDS rc=0
  shift 2
  ((limit > deadline - SECONDS)) && limit=$((deadline - SECONDS))
  if ((limit < 5)); then
    fail "$name" "no time was left"
    return 1
  fi
  echo "== $name"
  if declare -F "$1" > /dev/null; then set -- bash -c '"$@"' step "$@"; fi
  timeout "$limit" "$@" > "$out/$name.log" 2>&1 || rc=$?
  if ((rc == 0)); then
    row "$name" passed "$((SECONDS - begin)) s"
  else
    grep -nE '(^|[ :])(fatal )?error[: ]|FAILED|Error:' "$out/$name.log" | head -n 30 || tail -n 30 "$out/$name.log"
    local why="after $((SECONDS - begin)) s, $out/$name.log"
    ((rc == 124)) && why="not done in $limit s, $out/$name.log"
    fail "$name" "$why"
  fi
  save
  return $rc
}

# on_gpu PROGRAM NAME SECONDS COMMAND...: a step that needs a GPU and a program that was built.
on_gpu() {
  local program=$1
  shift
  if [[ -z $gpu ]]; then
    skip "$1" "no NVIDIA driver answers"
  elif [[ ! -x $bin/$program ]]; then
    skip "$1" "$program was not built"
  else
    step "$@"
  fi
}

# build NAME SECONDS TARGET...: as much of the targets as compiles.
build() {
  local name=$1 limit=$2
  shift 2
  [[ -f $tree/build.ninja ]] || { skip "$name" "not configured"; return; }
  step "$name" "$limit" cmake --build "$tree" --parallel "$jobs" --target "$@" -- -k 0
}

# Makes the packed libraries known to CMake, pkg-config and the programs that are built, and to nothing else.
use_packages() {
  local root=$PWD/build/gpu_packages
  rm -rf "$root" && mkdir -p "$root" && tar xzf "$packages" -C "$root" || { fail packages "$packages cannot be unpacked"; finish; }
  local lib
  lib=$(echo "$root"/usr/lib/*-linux-gnu)
  export CMAKE_PREFIX_PATH=$root/usr PKG_CONFIG_LIBDIR=$lib/pkgconfig:$root/usr/share/pkgconfig PKG_CONFIG_SYSROOT_DIR=$root
  local link="-Wl,--disable-new-dtags,-rpath,$lib"  # an RPATH, unlike a RUNPATH, also finds what these libraries need
  configure+=(-DCMAKE_LIBRARY_ARCHITECTURE="${lib##*/}" -DCMAKE_EXE_LINKER_FLAGS="$link" -DCMAKE_SHARED_LINKER_FLAGS="$link")
  if ! command -v pkg-config > /dev/null; then
    printf '#!/bin/sh\nLD_LIBRARY_PATH=%s exec %s/usr/bin/pkgconf "$@"\n' "$lib" "$root" > "$root/pkg-config"
    chmod +x "$root/pkg-config"
    configure+=(-DPKG_CONFIG_EXECUTABLE="$root/pkg-config")
  fi
}

# Runs each suite in a process of its own, since an illegal address fails every later test of a process: first those that
# compare with reference numbers and with finite differences.
suites() {
  local all first suite begin=$SECONDS passed=0 bad=0
  all=$("$bin/cuda_tests" --gtest_list_tests | grep -oE '^[A-Za-z0-9_/]+\.') || return 1
  first=$(grep -E 'Golden|FiniteDifferences|SplatMath|Rasterizer|Photometric' <<<"$all")
  for suite in $first $(grep -vxF "$first" <<<"$all"); do
    local log=$out/tests/${suite//\//_}log
    if ((SECONDS - begin > $1)); then
      fail "tests $suite" "no time was left"
      bad=1
    elif ! timeout 60 "$bin/cuda_tests" --gtest_brief=1 --gtest_filter="$suite*" > "$log" 2>&1; then
      fail "tests $suite" "$log"
      tail -n 12 "$log"
      bad=1
    elif grep -q SKIPPED "$log"; then
      fail "tests $suite" "a skipped test is no success, $log"
      bad=1
    else
      passed=$((passed + 1))
    fi
  done
  row suites passed "$passed"
  return $bad
}

# bench NAME SECONDS GPU_BENCH_ARGUMENTS...: prints what was measured, at once, also when it failed or ran out of time.
bench() {
  local name=$1 limit=$2
  shift 2
  on_gpu gpu_bench "$name" "$limit" "$bin/gpu_bench" --json "$out/$name.json" "$@"
  [[ ! -s $out/$name.log ]] || cat "$out/$name.log"
}

# trained FILE.ply transforms.json: a trained scene at one megapixel and at four.
large=2474x1644
trained() {
  bench trained 60 --parts training --scene "$1" --views "$2"
  bench trained_large 60 --parts training --scene "$1" --views "$2" --size $large
}

# The same 500 iterations on both devices.
demo() {
  "$bin/oraclegs" demo-scene "$out/demo" || return
  for device in cpu cuda; do
    "$bin/oraclegs" reconstruct "$out/demo" -o "$out/demo_$device" --device $device --iterations 500 --max-gaussians 100000 \
      --proposals 0 --eval --quiet || return
  done
}
# A model of a million and a half Gaussians with the overlaps and the depths of a trained one.
train() {
  "$bin/oraclegs" demo-scene "$out/room" --demo-views 24 --width 960 --height 720 --samples 2 &&
    "$bin/oraclegs" train "$out/room" -o "$out/room_trained" --device cuda --iterations 4000 --max-gaussians 1500000 \
      --proposals 0 --quiet
}

export -f row fail suites demo train

# Writes the figures beside what is expected to $out/figures.txt.
figures() {
  python3 - "$out" > "$out/figures.txt" <<'PY' || failed=1
import json, sys
from pathlib import Path
out, bad = Path(sys.argv[1]), False
EXPECTED = {  # on an H200, of a million synthetic Gaussians at 1237 x 822
    "iteration_ms": ("iteration", " ms", 2.5), "forward_ms": ("forward", " ms", 0.8),
    "training_bytes_per_gaussian": ("bytes a Gaussian", "", 1080)}
LIMITS = {  # of the other runs
    "compact": {"training_bytes_per_gaussian": 800}, "trained_large": {"iteration_ms": 6.0}}
def line(label, mark, text):
    print(f"{label:<22} {mark:<8} {text}")
def read(path):
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError):
        return {}
for name in ("benchmark", "small", "compact", "trained", "trained_large"):
    values = read(out / f"{name}.json")
    for key in (key for key in EXPECTED if key in values):
        label, unit, limit = EXPECTED[key]
        if name != "benchmark":
            label, limit = f"{label}, {name}", LIMITS.get(name, {}).get(key)
        text = f"{values[key]:.{3 if unit else 0}f}{unit}"
        if limit:
            line(label, "good" if values[key] <= limit else "MISSED", f"{text} (expected on an H200: at most {limit}{unit})")
        else:
            line(label, "", f"{text}, {values['gaussians']:.0f} Gaussians")
psnr = [read(out / f"demo_{device}/metrics.json").get("test", {}).get("psnr") for device in ("cpu", "cuda")]
if (out / "demo_cuda/metrics.json").exists() and None in psnr:
    bad = True
    line("demo, PSNR", "MISSED", "the runs have no test views")
elif None not in psnr:
    bad = abs(psnr[0] - psnr[1]) > 0.4  # two seeds on one device differ by as much
    line("demo, PSNR", "MISSED" if bad else "good", "CPU %.3f, GPU %.3f dB (expected: within 0.4 dB)" % tuple(psnr))
sys.exit(bad)
PY
}

[[ -d /usr/local/cuda/bin ]] && PATH=$PATH:/usr/local/cuda/bin:/usr/local/cuda/compute-sanitizer
for tool in cmake ninja nvcc g++ python3; do
  command -v $tool > /dev/null || fail "$tool" "is not on the PATH"
done
((failed)) && finish
gpu=$(nvidia-smi --query-gpu=name,compute_cap,driver_version,memory.total --format=csv,noheader 2> /dev/null | head -n 1)
architecture=$(cut -d, -f2 <<<"$gpu" | tr -d ' .')
[[ -n $gpu ]] && row GPU found "$gpu" || fail GPU "no NVIDIA driver answers: everything is built, for an H200, and nothing is run"

configure=(--preset cuda -DORACLEGS_NETWORKS=$([[ $networks ]] && echo ON || echo OFF) -DORACLEGS_WERROR=OFF -DCMAKE_CUDA_FLAGS=-Xptxas=-v
           -DCMAKE_CUDA_ARCHITECTURES="${architecture:-90}")
[[ -z $packages ]] || use_packages
if [[ -n $networks ]]; then
  torch=$(python3 -c 'import torch; print(torch.utils.cmake_prefix_path)' 2> /dev/null) || { fail PyTorch "python3 has none"; finish; }
  export CMAKE_PREFIX_PATH=$torch${CMAKE_PREFIX_PATH:+:$CMAKE_PREFIX_PATH}
  step configure 100 cmake "${configure[@]}" -B "$tree" -DORACLEGS_PYTHON=OFF || finish
  build build_networks 400 seva_bench vggt_bench networks_torch_tests
  on_gpu seva_bench seva 120 "$bin/seva_bench" 21 576 bfloat16 batched cuda
  on_gpu seva_bench seva_autocast 120 "$bin/seva_bench" 21 576 autocast batched cuda
  on_gpu vggt_bench vggt 90 "$bin/vggt_bench" --views 12 --device cuda
  if [[ -f tests/golden/seva_unet_tiny.safetensors ]]; then
    on_gpu networks_torch_tests networks_tests 200 "$bin/networks_torch_tests" --gtest_brief=1
  else
    skip networks_tests "this copy has no reference numbers of networks in tests/golden"
  fi
  cat "$out"/{seva,seva_autocast,vggt}.log 2> /dev/null
  finish
fi
# Without the libraries of the program, or of the tests, the benchmark can still be built.
step configure 100 cmake "${configure[@]}" -DORACLEGS_APPS=ON -DORACLEGS_TESTS=ON ||
  step configure_engine 60 cmake "${configure[@]}" -DORACLEGS_APPS=OFF -DORACLEGS_TESTS=ON ||
  step configure_benchmark 60 cmake "${configure[@]}" -DORACLEGS_APPS=OFF -DORACLEGS_TESTS=OFF || finish

build build_benchmark 300 gpu_bench
if [[ -n $gsplat ]]; then
  name=benchmark of_scene=()
  [[ -z $scene ]] || name=trained_large of_scene=(--scene "$scene" --views "$views" --size $large)
  bench $name 90 --parts training --dump "$out/scene" "${of_scene[@]}"
  export TORCH_CUDA_ARCH_LIST=${TORCH_CUDA_ARCH_LIST:-$(cut -d, -f2 <<<"$gpu" | tr -d ' ')} MAX_JOBS=$jobs
  on_gpu gpu_bench gsplat 480 python3 bench/gsplat_bench.py "$out/scene" "$out/$name.json" "$gsplat"
  [[ ! -s $out/gsplat.log ]] || tail -n 5 "$out/gsplat.log"
  finish
fi
bench benchmark 90

build build_tests 300 cuda_tests
on_gpu cuda_tests tests 160 suites 150

bench small 30 --parts training --gaussians 100000 --size 480x270
bench compact 30 --parts training --sh-moments compact
[[ -z $scene ]] || trained "$scene" "$views"

# Duration, memory and arithmetic throughput of the five kernels that an iteration spends most of its time in, in two iterations.
if command -v ncu > /dev/null; then
  kernels='^(ProjectKernel|BlendForwardKernel|PhotometricStatistics|BlendBackwardKernel|GaussianBackwardKernel)$'
  on_gpu gpu_bench ncu 90 ncu --clock-control none --section SpeedOfLight --section Occupancy --section LaunchStats \
    --section MemoryWorkloadAnalysis -k "regex:$kernels" --launch-skip 31 --launch-count 14 "$bin/gpu_bench" --parts training --passes 1
  grep -hE '^  [A-Za-z].*(Kernel|Photometric)|^ +(Duration|Memory Throughput|Compute \(SM\) Throughput|Registers Per|Achieved Occ)' \
    "$out/ncu.log" 2> /dev/null
else
  skip ncu "not on the PATH"
fi

build build_program 300 oraclegs
on_gpu oraclegs demo 120 demo
if [[ -z $scene ]]; then
  on_gpu oraclegs train 100 train
  [[ ! -f $out/room_trained/point_cloud.ply ]] ||
    trained "$out/room_trained/point_cloud.ply" "$out/room/transforms.json"
fi

# sanitize NAME SECONDS FILTER OPTIONS...
sanitize() {
  local name=$1 limit=$2 filter=$3
  shift 3
  if command -v compute-sanitizer > /dev/null; then
    on_gpu cuda_tests "$name" "$limit" compute-sanitizer "$@" --error-exitcode 9 "$bin/cuda_tests" --gtest_brief=1 --gtest_filter="$filter"
  else
    skip "$name" "no compute-sanitizer on the PATH"
  fi
}
between=*AddNormTest*:FrameAttentionTest*:GatedGeluTest*:*GroupNormKernels*  # what lies between the networks' products
sanitize memcheck 90 "$between"':*RasterizerGolden*sh3:*RasterizerScenes*/huge:*LaunchTest*:GpuTrainingTest.Measures*:RasterCoreTest.BucketsOf*:RasterCoreTest.TheBackward*:CudaPlaneSearchTest.Silhouettes*'
sanitize racecheck 60 "$between"':*RasterizerGolden*sh3:*Photometric*' --tool racecheck
finish

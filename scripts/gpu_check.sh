#!/usr/bin/env bash
# Builds with CUDA, runs what needs a GPU and prints one table last; within 9 minutes on 16 cores.
#   scripts/gpu_check.sh [--gsplat PATH]     PATH: gsplat's source, to be timed on the same scene
# On a machine with only the CUDA toolkit, CMake, Ninja and a Python with PyTorch, bring the missing packages along:
#   ../shared/tools/gpu_bundle.sh libsqlite3-dev libsqlite3-0     here; copy the checkout with its .gpu/ there
# Exit code 0 when every step passed or was skipped.
set -uo pipefail
cd "$(dirname "$0")/.."

gsplat=
while (($#)); do
  case "$1" in
    --gsplat) gsplat=${2:?--gsplat PATH}; shift 2 ;;
    *) echo "usage: scripts/gpu_check.sh [--gsplat PATH]" >&2; exit 2 ;;
  esac
done
deadline=$((SECONDS + 530))
out=build/gpu_check
mkdir -p "$out"
rows=()
failed=0

# step NAME SECONDS COMMAND...: its log is $out/NAME.log; the last lines of a failed one are shown.
step() {
  local name=$1 limit=$2 begin=$SECONDS result=passed
  shift 2
  ((limit > deadline - SECONDS)) && limit=$((deadline - SECONDS))
  if ((limit < 5)); then
    rows+=("$(printf '%-22s %-8s %5s' "$name" 'no time' '')"); failed=1
    return 1
  fi
  echo "== $name"
  timeout "$limit" "$@" > "$out/$name.log" 2>&1
  local rc=$?
  if ((rc != 0)); then
    result=FAILED; failed=1
    ((rc == 124)) && result='too slow'
    tail -n 40 "$out/$name.log"
  fi
  rows+=("$(printf '%-22s %-8s %4ds' "$name" "$result" $((SECONDS - begin)))")
  return $rc
}
skip() { rows+=("$(printf '%-22s %-8s %s' "$1" skipped "$2")"); }

finish() {
  echo
  [[ -s $out/benchmark.log ]] && cat "$out/benchmark.log" && echo
  [[ -s $out/gsplat.log ]] && cat "$out/gsplat.log" && echo
  printf '%s\n' "${rows[@]}"
  exit $failed
}

if [[ -f .gpu/env.sh ]]; then
  set +u
  . .gpu/env.sh
  set -u
fi
[[ -d /usr/local/cuda/bin ]] && PATH=$PATH:/usr/local/cuda/bin
nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader 2>/dev/null || echo "no NVIDIA driver answers"

step configure 60 cmake --preset cuda -DCMAKE_CUDA_ARCHITECTURES="${ORACLEGS_CUDA_ARCH:-native}" || finish
step build 360 cmake --build --preset cuda --target cuda_tests gpu_bench oraclegs || finish
bin=build/cuda/bin

# Golden numbers, CPU against GPU, finite differences: GTEST_SKIP without a device must not look like success.
step tests 120 bash -c "set -o pipefail; $bin/cuda_tests --gtest_brief=1 | tee $out/tests.txt && ! grep SKIPPED $out/tests.txt"
if command -v compute-sanitizer >/dev/null; then
  step sanitizer 100 compute-sanitizer --error-exitcode 9 "$bin/cuda_tests" --gtest_brief=1 \
    --gtest_filter='*RasterizerGolden*sh3:*RasterizerScenes*/huge:*LaunchTest*'
else
  skip sanitizer "no compute-sanitizer"
fi
mkdir -p "$out/scene"
step benchmark 60 "$bin/gpu_bench" --dump "$out/scene"
if [[ -n $gsplat ]] || python3 -c 'import gsplat' 2>/dev/null; then
  step gsplat 60 python3 bench/gsplat_bench.py "$out/scene" ${gsplat:+"$gsplat"}
else
  skip gsplat "not installed; --gsplat PATH"
fi

# The same 500 iterations on both devices.
if "$bin/oraclegs" reconstruct --help 2>/dev/null | grep -q -- --device; then
  demo() { "$bin/oraclegs" reconstruct "$out/demo" -o "$out/demo_$1" --device "$1" --iterations 500 --quiet; }
  compare() {
    rm -rf "$out/demo" "$out/demo_cpu" "$out/demo_cuda"
    "$bin/oraclegs" demo-scene "$out/demo" && demo cpu && demo cuda && python3 - "$out" <<'PY'
import json, sys
psnr = [json.load(open(f"{sys.argv[1]}/demo_{device}/metrics.json"))["test"]["psnr"] for device in ("cpu", "cuda")]
print("PSNR cpu %.3f, cuda %.3f dB" % tuple(psnr))
sys.exit(abs(psnr[0] - psnr[1]) > 0.1)
PY
  }
  export -f demo compare
  export bin out
  step demo_scene 120 bash -c compare
else
  skip demo_scene "reconstruct has no --device"
fi
finish

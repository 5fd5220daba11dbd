#!/usr/bin/env bash
# Builds with CUDA, runs what needs a GPU and prints one table last; within 9 minutes on 16 cores.
#   scripts/gpu_check.sh [--gsplat PATH]     PATH: gsplat's source, to be timed on the same scene
# On a machine with only the CUDA toolkit, CMake, Ninja and a Python with PyTorch 2.6 or later, bring the missing
# packages along: on a machine with Debian's packages run
#   scripts/gpu_check.sh --bundle ../shared/tools/gpu_bundle.sh     packs them into .gpu/
# and copy the checkout with its .gpu/.
# Exit code 0 when every step passed or was skipped.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 2

# Beyond what gpu_bundle.sh brings: SQLite, pkg-config, and curl with all that its library loads.
bundle_packages=(zlib1g libsqlite3-dev libsqlite3-0 pkgconf pkgconf-bin libpkgconf3 libcurl4-openssl-dev libcurl4
                 libnghttp2-14 libidn2-0 libunistring2 librtmp1 libgnutls30 libhogweed6 libnettle8 libgmp10 libp11-kit0 libffi8
                 libtasn1-6 libssh2-1 libpsl5 libssl3 libgssapi-krb5-2 libkrb5-3 libk5crypto3 libkrb5support0
                 libcom-err2 libkeyutils1 libldap-2.5-0 libsasl2-2 libzstd1 libbrotli1)
gsplat=
while (($#)); do
  case "$1" in
    --gsplat) gsplat=${2:?--gsplat PATH}; shift 2 ;;
    --bundle) exec "${2:?--bundle PATH of gpu_bundle.sh}" "${bundle_packages[@]}" ;;
    *) echo "usage: scripts/gpu_check.sh [--gsplat PATH | --bundle PATH]" >&2; exit 2 ;;
  esac
done
deadline=$((SECONDS + 530))
out=build/gpu_check
rm -rf "$out" && mkdir -p "$out/scene"
rows=()
failed=0

row() { rows+=("$(printf '%-22s %-8s %s' "$1" "$2" "$3")"); }
skip() { row "$1" skipped "$2"; }
# fail NAME WHY
fail() { row "$1" FAILED "$2"; failed=1; }

# step NAME SECONDS COMMAND...: its log is $out/NAME.log; the last lines of a failed one are shown.
step() {
  local name=$1 limit=$2 begin=$SECONDS rc=0
  shift 2
  ((limit > deadline - SECONDS)) && limit=$((deadline - SECONDS))
  if ((limit < 5)); then
    row "$name" "no time" ""; failed=1
    return 1
  fi
  echo "== $name"
  timeout "$limit" "$@" > "$out/$name.log" 2>&1 || rc=$?
  if ((rc == 0)); then
    row "$name" passed "$((SECONDS - begin)) s"
  else
    tail -n 40 "$out/$name.log"
    local why="after $((SECONDS - begin)) s, $out/$name.log"
    ((rc == 124)) && why="not done in $limit s"
    fail "$name" "$why"
  fi
  return $rc
}

finish() {
  echo
  cat "$out/benchmark.log" "$out/gsplat.log" 2>/dev/null && echo
  printf '%s\n' "${rows[@]}"
  [[ -s $out/figures.txt ]] && cat "$out/figures.txt"
  exit $failed
}

if [[ -f .gpu/env.sh ]]; then
  set +u
  . .gpu/env.sh
  set -u
  PATH=$PATH:$PWD/.gpu/deps/usr/bin
  # Of libraries that nothing is built against the machine's own are better than ours.
  known=$(ldconfig -p 2>/dev/null)
  for file in .gpu/deps/{usr/,}lib/x86_64-linux-gnu/*.so.*; do
    name=$(basename "$file")
    [[ -e ${file%%.so.*}.so ]] || ! grep -qF "$name (" <<<"$known" || rm -f "$file"
  done
  export LD_LIBRARY_PATH=$LD_LIBRARY_PATH:$PWD/.gpu/deps/lib/x86_64-linux-gnu
fi
[[ -d /usr/local/cuda/bin ]] && PATH=$PATH:/usr/local/cuda/bin:/usr/local/cuda/compute-sanitizer
for tool in cmake ninja nvcc g++ python3 pkg-config; do
  command -v $tool >/dev/null || fail "$tool" "is not on the PATH"
done
torch=$(python3 -c 'import torch
print(torch.__version__, "CUDA", torch.version.cuda, "ABI", int(torch._C._GLIBCXX_USE_CXX11_ABI))' 2>/dev/null)
case "$torch" in
  *"CUDA None"*) fail torch "$torch: PyTorch for the CPU; Python's must be one with CUDA" ;;
  *"ABI 0"*) fail torch "$torch: of the old C++ ABI; PyTorch 2.6 or later has the new one" ;;
  "") [[ -n $(python3 -c 'print(1)' 2>/dev/null) ]] && fail torch "python3 cannot import torch" ;;
  *) row torch found "$torch" ;;
esac
((failed)) && finish
nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader 2>/dev/null || echo "no NVIDIA driver answers"

# Warnings of compilers that we do not have are no errors; libraries that libtorch loads are found when it is loaded.
step configure 150 cmake --preset cuda -DCMAKE_CUDA_ARCHITECTURES="${ORACLEGS_CUDA_ARCH:-native}" -DORACLEGS_WERROR=OFF \
  -DCMAKE_EXE_LINKER_FLAGS=-Wl,--allow-shlib-undefined || finish
step build 380 cmake --build --preset cuda --parallel "${ORACLEGS_JOBS:-16}" --target cuda_tests gpu_bench oraclegs || finish
bin=build/cuda/bin

# Golden numbers, CPU against GPU, finite differences: GTEST_SKIP without a device must not look like success.
step tests 120 bash -c "set -o pipefail; $bin/cuda_tests --gtest_brief=1 | tee $out/tests.txt && ! grep SKIPPED $out/tests.txt"
step benchmark 60 "$bin/gpu_bench" --dump "$out/scene"
if [[ -n $gsplat ]] || python3 -c 'import gsplat' 2>/dev/null; then
  step gsplat 60 python3 bench/gsplat_bench.py "$out/scene" ${gsplat:+"$gsplat"}
else
  skip gsplat "not installed; --gsplat PATH"
fi

# The same 500 iterations on both devices.
demo() {
  "$bin/oraclegs" reconstruct "$out/demo" -o "$out/demo_$1" --device "$1" --iterations 500 --proposals 0 --quiet
}
compare() { "$bin/oraclegs" demo-scene "$out/demo" && demo cpu && demo cuda; }
export -f demo compare
export bin out
step demo_scene 120 bash -c compare

if command -v compute-sanitizer >/dev/null; then
  step memcheck 90 compute-sanitizer --error-exitcode 9 "$bin/cuda_tests" --gtest_brief=1 \
    --gtest_filter='*RasterizerGolden*sh3:*RasterizerScenes*/huge:*LaunchTest*:GpuTrainingTest.Measures*:CudaPlaneSearchTest.Silhouettes*'
  step racecheck 60 compute-sanitizer --tool racecheck --error-exitcode 9 "$bin/cuda_tests" --gtest_brief=1 \
    --gtest_filter='*RasterizerGolden*sh3:*Photometric*'
else
  skip memcheck "no compute-sanitizer"
fi

# What issue 6 asks for; on another GPU than an H200 the times are only told.
python3 - "$out" > "$out/figures.txt" <<'PY' || failed=1
import json, sys
from pathlib import Path
out, bad = Path(sys.argv[1]), False
def figure(name, value, wanted, good):
    print("%-22s %-8s %s (wanted: %s)" % (name, "good" if good else "MISSED", value, wanted))
try:
    ours = json.loads((out / "scene/ours.json").read_text())
    figure("iteration", "%.3f ms" % ours["iteration_ms"], "4 ms on an H200", ours["iteration_ms"] <= 4)
    figure("forward", "%.3f ms" % ours["forward_ms"], "0.8 ms on an H200", ours["forward_ms"] <= 0.8)
    figure("bytes a Gaussian", "%.0f" % ours["training_bytes_per_gaussian"], "800", ours["training_bytes_per_gaussian"] <= 800)
except (OSError, ValueError, KeyError) as error:
    print("%-22s %-8s %s" % ("benchmark figures", "none", error))
try:
    psnr = [json.loads((out / f"demo_{device}/metrics.json").read_text())["test"]["psnr"] for device in ("cpu", "cuda")]
    bad = abs(psnr[0] - psnr[1]) > 0.1
    figure("demo scene, PSNR", "cpu %.3f, cuda %.3f dB" % tuple(psnr), "within 0.1 dB", not bad)
except (OSError, ValueError, KeyError, TypeError) as error:
    print("%-22s %-8s %s" % ("demo scene, PSNR", "none", error))
sys.exit(bad)
PY
finish

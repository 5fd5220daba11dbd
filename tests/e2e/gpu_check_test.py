#!/usr/bin/env python3
"""What of the GPU check needs no GPU: its order, its table, its exit code and its archive; what is packed for a machine with
one; and the line about gsplat. The tools are stand-ins that are found before the machine's."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

BUILT = {
    # cuda_tests --gtest_list_tests, or --gtest_brief=1 --gtest_filter=SUITE.* with the others
    "cuda_tests": """case "$*" in
*list*) printf 'Running main() from gmock_main.cc\\nCudaStep.\\n  Noise\\nVariants/CudaRasterizerGolden.\\n  Match/sh3  # GetParam()\\n' ;;
*CudaStep*) echo "$STUB_STEP"; echo step >> order.txt ;;
*) echo "[  PASSED  ] 1 test."; echo golden >> order.txt ;;
esac""",
    "gpu_bench": """while (($#)); do [[ $1 != --json ]] || json=$2; shift; done
echo "the table of ${json##*/}"
echo '{"iteration_ms": 2.4, "forward_ms": 0.9, "training_bytes_per_gaussian": 790, "gaussians": 5}' > "$json"
exit "$STUB_BENCH" """,
    "seva_bench": 'echo "a step of $*"',
    "vggt_bench": 'echo "a pass of $*"',
    "networks_torch_tests": 'echo "[  PASSED  ] 1 test."',
    # reconstruct or train SCENE -o OUT --device DEVICE ...
    "oraclegs": """[ "$1" = demo-scene ] && exit 0
[ "$6" = cuda ] && psnr=$STUB_PSNR || psnr=30.00
mkdir -p "$4" && echo "{\\"test\\": {\\"psnr\\": $psnr}}" > "$4/metrics.json" && touch "$4/point_cloud.ply" """,
}
TOOLS = {
    "cmake": """if [ "$1" != --build ]; then
  case "$*" in *APPS=ON*) [ "$STUB_APPS" = yes ] || { echo "CMake Error: no curl"; exit 1; } ;; esac
  tree=build/cuda; while (($#)); do [ "$1" != -B ] || tree=$2; shift; done
  mkdir -p $tree && touch $tree/build.ninja; echo "paths $CMAKE_PREFIX_PATH"; exit
fi
tree=$2; shift 5
while [ "$1" != -- ]; do
  [ "$STUB_BUILD" = "$1" ] && { echo "x.cpp:1:2: error: a bad file"; exit 1; }
  mkdir -p $tree/bin && cp "$STUB_BUILT/$1" $tree/bin/; shift
done""",
    "python3": """case "$*" in
*'import torch'*) [ -n "$STUB_TORCH" ] && echo "$STUB_TORCH" ;;
*) exec /usr/bin/python3 "$@" ;;
esac""",
    "ninja": "",
    "nvcc": "",
    "g++": "",
    "nvidia-smi": """[ -n "$STUB_GPU" ] && echo "$STUB_GPU" """,
    "compute-sanitizer": "",
    "ncu": "echo '  BlendForwardKernel (1, 1, 1)'",
}
GOOD = {"STUB_STEP": "[  PASSED  ] 9 tests.", "STUB_BENCH": "0", "STUB_PSNR": "30.05", "STUB_APPS": "yes", "STUB_BUILD": "",
        "STUB_TORCH": "/torch/cmake", "STUB_GPU": "NVIDIA H200, 9.0, 580.1, 143771 MiB"}  # fmt: skip


def write_programs(folder, programs):
    folder.mkdir(parents=True)
    for name, text in programs.items():
        (folder / name).write_text(f"#!/bin/bash\n{text}\n")
        (folder / name).chmod(0o755)


class WithStandIns(unittest.TestCase):
    def setUp(self):
        self.dir = Path(tempfile.mkdtemp(prefix="oraclegs_gpu_check_"))
        self.addCleanup(shutil.rmtree, self.dir)
        write_programs(self.dir / "tools", TOOLS)
        write_programs(self.dir / "built", BUILT)
        (self.dir / "scripts").mkdir()
        (self.dir / "bench").mkdir()
        for file in ("scripts/gpu_check.sh", "scripts/gpu_pack.sh", "scripts/bootstrap.sh", "bench/gsplat_bench.py"):
            shutil.copy(ROOT / file, self.dir / file)

    def run_script(self, *words, **stubs):
        environment = dict(os.environ, PATH=f"{self.dir}/tools:/usr/bin:/bin", STUB_BUILT=str(self.dir / "built"), **{**GOOD, **stubs})
        environment.setdefault("OUT", str(self.dir))
        return subprocess.run(words, capture_output=True, text=True, env=environment, timeout=120, check=False)

    def check(self, *arguments, **stubs):
        return self.run_script(self.dir / "scripts/gpu_check.sh", *arguments, **stubs)

    def assert_row(self, done, name, rest):
        self.assertRegex(done.stdout, rf"(?m)^{name} +{rest}$")


class GpuCheckTest(WithStandIns):
    def test_all_good(self):
        done = self.check()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        steps = ["configure", "build_benchmark", "benchmark", "build_tests", "tests", "small", "compact", "ncu",
                 "build_program", "demo", "train", "trained", "trained_large", "memcheck", "racecheck"]  # fmt: skip
        rows = [line.split()[0] for line in done.stdout.splitlines() if " passed " in line and not line.startswith("suites")]
        self.assertEqual(rows, steps)
        self.assert_row(done, "GPU", "found +NVIDIA H200, .*")
        self.assert_row(done, "suites", "passed +2")
        self.assertIn("the table of benchmark.json", done.stdout)
        self.assert_row(done, "iteration", r"good +2\.400 ms \(expected on an H200: at most 2.5 ms\)")
        self.assert_row(done, "forward", r"MISSED +0\.900 ms .*")
        self.assert_row(done, "iteration, trained", r"2\.400 ms, 5 Gaussians")
        self.assert_row(done, "iteration, trained_large", r"good +2\.400 ms \(expected on an H200: at most 6.0 ms\)")
        self.assert_row(done, "bytes a Gaussian, compact", r"good +790 .*")
        self.assert_row(done, "demo, PSNR", r"good +CPU 30\.000, GPU 30\.050 dB .*")
        self.assertNotIn("--packages", done.stdout)

    def test_reference_numbers_come_first(self):
        self.check()
        self.assertEqual((self.dir / "order.txt").read_text().split()[:2], ["golden", "step"])

    def test_logs_and_figures_are_one_archive(self):
        self.check()
        with tarfile.open(self.dir / "gpu_check.tar.gz") as archive:
            names = archive.getnames()
        for name in ("configure.log", "benchmark.json", "tests/CudaStep.log", "summary.txt", "figures.txt"):
            self.assertIn(f"gpu_check/{name}", names)

    def test_the_benchmark_survives_the_others(self):
        done = self.check(STUB_BUILD="cuda_tests")
        self.assertEqual(done.returncode, 1)
        self.assertIn("error: a bad file", done.stdout)
        self.assert_row(done, "build_tests", "FAILED +.*")
        self.assert_row(done, "tests", "skipped +cuda_tests was not built")
        self.assert_row(done, "demo", "passed .*")
        done = self.check(STUB_BUILD="oraclegs", STUB_BENCH="1")
        self.assert_row(done, "benchmark", "FAILED +.*")
        self.assert_row(done, "iteration", "good .*")  # what it had saved

    def test_without_the_programs_libraries_the_engine_is_checked(self):
        done = self.check(STUB_APPS="no")
        self.assertEqual(done.returncode, 1)
        self.assert_row(done, "configure", "FAILED .*")
        self.assert_row(done, "configure_engine", "passed .*")
        self.assert_row(done, "tests", "passed .*")

    def test_without_a_gpu_everything_is_built_and_nothing_is_run(self):
        done = self.check(STUB_GPU="")
        self.assertEqual(done.returncode, 1)
        for name in ("build_benchmark", "build_tests", "build_program"):
            self.assert_row(done, name, "passed .*")
        for name in ("benchmark", "tests", "small", "ncu", "demo", "memcheck"):
            self.assert_row(done, name, "skipped +no NVIDIA driver answers")

    def test_devices_that_disagree(self):
        done = self.check(STUB_PSNR="30.50")
        self.assertEqual(done.returncode, 1)
        self.assert_row(done, "demo, PSNR", r"MISSED +CPU 30\.000, GPU 30\.500 dB .*")

    def test_a_demo_that_scores_nothing(self):
        done = self.check(STUB_PSNR="null")
        self.assertEqual(done.returncode, 1)
        self.assert_row(done, "demo, PSNR", r"MISSED +the runs have no test views")

    def test_skipped_tests_are_no_success(self):
        done = self.check(STUB_STEP="[  SKIPPED ] 3 tests.")
        self.assertEqual(done.returncode, 1)
        self.assert_row(done, "tests CudaStep.", "FAILED +a skipped test is no success, .*")
        self.assert_row(done, "tests", "FAILED .*")

    def test_time_that_runs_out(self):
        done = self.check("--seconds", "0")
        self.assertEqual(done.returncode, 1)
        self.assert_row(done, "configure", "FAILED +no time was left")

    def test_a_scene_of_the_users(self):
        done = self.check("--scene", "model.ply", "--views", "transforms.json")
        self.assert_row(done, "trained", "passed .*")
        self.assertNotRegex(done.stdout, r"(?m)^train ")

    def test_a_scene_that_would_be_deleted(self):
        scene = self.dir / "build/gpu_check/room_trained/point_cloud.ply"
        scene.parent.mkdir(parents=True)
        scene.touch()
        done = self.check("--scene", str(scene), "--views", "transforms.json")
        self.assertEqual(done.returncode, 2)
        self.assertIn("copy it", done.stderr)
        self.assertTrue(scene.exists())

    def test_gsplat_is_a_call_of_its_own(self):
        done = self.check("--gsplat", str(self.dir / "nowhere"))
        self.assertEqual(done.returncode, 1)
        self.assert_row(done, "benchmark", "passed .*")
        self.assertIn("gsplat: not timed", done.stdout)
        self.assertNotRegex(done.stdout, r"(?m)^tests ")
        done = self.check("--gsplat", str(self.dir / "nowhere"), "--scene", "model.ply", "--views", "transforms.json")
        self.assert_row(done, "trained_large", "passed .*")
        self.assertNotRegex(done.stdout, r"(?m)^benchmark ")

    def test_networks_are_a_call_of_their_own(self):
        golden = self.dir / "tests/golden/seva_unet_tiny.safetensors"
        golden.parent.mkdir(parents=True)
        golden.touch()
        done = self.check("--networks")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        rows = [line.split()[0] for line in done.stdout.splitlines() if " passed " in line]
        self.assertEqual(rows, ["configure", "build_networks", "seva", "seva_autocast", "vggt", "networks_tests"])
        self.assertIn("paths /torch/cmake", (self.dir / "build/gpu_check/configure.log").read_text())
        self.assertIn("a step of 21 576 bfloat16 batched cuda", done.stdout)
        self.assertIn("a pass of --views 12 --device cuda", done.stdout)
        golden.unlink()
        self.assert_row(self.check("--networks"), "networks_tests", "skipped +this copy has no reference numbers .*")
        done = self.check("--networks", STUB_TORCH="")
        self.assertEqual(done.returncode, 1)
        self.assert_row(done, "PyTorch", "FAILED +python3 has none")

    def test_other_words(self):
        for words in (["--gsplats"], ["--scene", "model.ply"], ["--networks", "--gsplat", "gsplat"]):
            done = self.check(*words)
            self.assertEqual(done.returncode, 2)
            self.assertIn("usage:", done.stderr)

    def test_packages_that_are_none(self):
        done = self.check("--packages", "nowhere.tar.gz")
        self.assertEqual(done.returncode, 1)
        self.assert_row(done, "packages", "FAILED +.*nowhere.tar.gz cannot be unpacked")


class GpuPackTest(WithStandIns):
    def test_packs_headers_libraries_and_the_source(self):
        """apt's packages are stand-ins: one with a library, its archive, an absolute link, headers of its own, and things not
        needed."""
        folder = self.dir / "pack"
        write_programs(self.dir / "apt", {
            "apt-cache": "echo \"$*\" > \"$STUB_ASKED\"; printf 'libfmt-dev\\n  Depends: libc6\\nlibc6\\n'",
            "apt-get": "cat > names.txt; touch x.deb; for name in \"$@\"; do echo \"$name\" >> \"$STUB_NAMES\"; done",
            "dpkg-deb": """arch=x86_64-linux-gnu; lib=$3/usr/lib/$arch; mkdir -p $3/usr/include/$arch/openssl $lib/cmake/fmt $lib/perl $lib/glib-2.0/include $3/usr/include $3/usr/share/doc $3/usr/bin
touch $lib/libfmt.so.9 $lib/libfmt.a $lib/libgtest.a $lib/cmake/fmt/fmt-config.cmake $3/usr/include/fmt.h $3/usr/bin/pkgconf $3/usr/include/$arch/openssl/opensslconf.h
ln -s /lib/x86_64-linux-gnu/libfmt.so.9 $lib/libfmt.so""",
        })  # fmt: skip
        golden = self.dir / "tests/golden"
        golden.mkdir(parents=True)
        for name in ("ssim", "seva_unet_tiny"):
            (golden / f"{name}.safetensors").touch()
        os.rename(self.dir / "apt/apt-cache", self.dir / "tools/apt-cache")
        for tool in ("apt-get", "dpkg-deb"):
            os.rename(self.dir / "apt" / tool, self.dir / "tools" / tool)
        asked = self.dir / "asked"
        done = self.run_script(self.dir / "scripts/gpu_pack.sh", folder, STUB_NAMES=str(self.dir / "names"), STUB_ASKED=str(asked))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"packages.tar.gz +\d+ KiB, 1 packages")
        self.assertEqual((self.dir / "names").read_text().split()[-1], "libfmt-dev")
        packages = set(asked.read_text().split())
        self.assertLessEqual({"libheif-dev", "libtiff-dev", "libwebp-dev", "nlohmann-json3-dev", "zlib1g-dev", "libgmock-dev", "pkgconf"}, packages)
        self.assertFalse({"libtorch-dev", "libopenvdb-dev", "python3-dev", "build-essential"} & packages)
        with tarfile.open(folder / "packages.tar.gz") as archive:
            lib = "usr/lib/x86_64-linux-gnu"
            self.assertEqual(archive.getmember(f"{lib}/libfmt.so").linkname, "libfmt.so.9")
            names = archive.getnames()
        self.assertLessEqual({f"{lib}/glib-2.0/include", "usr/include/openssl/opensslconf.h"}, set(names))
        self.assertLessEqual({"usr/include/fmt.h", f"{lib}/libgtest.a", f"{lib}/cmake/fmt/fmt-config.cmake", "usr/bin/pkgconf"}, set(names))
        for name in (f"{lib}/libfmt.a", f"{lib}/perl", "usr/share/doc"):
            self.assertNotIn(name, names)
        with tarfile.open(folder / "source.tar.gz") as archive:
            names = archive.getnames()
        self.assertIn("oraclegs/tests/golden/ssim.safetensors", names)
        self.assertNotIn("oraclegs/tests/golden/seva_unet_tiny.safetensors", names)

    def test_other_words(self):
        done = self.run_script(self.dir / "scripts/gpu_pack.sh")
        self.assertEqual(done.returncode, 2)
        self.assertIn("usage:", done.stderr)


class GsplatBenchTest(unittest.TestCase):
    def setUp(self):
        spec = importlib.util.spec_from_file_location("gsplat_bench", ROOT / "bench/gsplat_bench.py")
        self.bench = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.bench)
        self.dir = Path(tempfile.mkdtemp(prefix="oraclegs_gsplat_"))
        self.addCleanup(shutil.rmtree, self.dir)

    def test_line(self):
        theirs = {"forward": 2.0, "backward": 5.0, "iteration": 9.0}
        alone = self.bench.line("1.5", theirs, {}, "fused_ssim")
        self.assertEqual(alone, "gsplat 1.5: forward 2.000 ms, backward 5.000 ms, iteration 9.000 ms (SSIM of fused_ssim)")
        ours = {"forward_ms": 0.8, "iteration_ms": 3.0}
        both = self.bench.line("1.5", theirs, ours, "fused_ssim")
        self.assertIn("; our forward 0.800 ms, 2.50 times as fast; our iteration 3.000 ms, 3.00 times as fast", both)
        unfair = self.bench.line("1.5", theirs, ours, "torch's convolutions")
        self.assertIn("2.50 times as fast; our iteration 3.000 ms, not comparable without fused_ssim", unfair)

    def test_reads_what_gpu_bench_wrote(self):
        (self.dir / "camera.txt").write_text("1237 822 1113.3 1138.04 617.2 411.7\n1 0 0 0.5 \n0 1 0 0 \n0 0 1 0 \n0 0 0 1 \n")
        width, height, intrinsics, pose = self.bench.read_camera(self.dir)
        self.assertEqual((width, height, intrinsics), (1237, 822, [[1113.3, 0, 617.2], [0, 1138.04, 411.7], [0, 0, 1]]))
        self.assertEqual(pose[0], [1, 0, 0, 0.5])
        self.assertEqual(self.bench.read_ours(self.dir / "ours.json"), {})
        (self.dir / "ours.json").write_text(json.dumps({"iteration_ms": 3}))
        self.assertEqual(self.bench.read_ours(self.dir / "ours.json"), {"iteration_ms": 3})

    def test_a_source_without_submodules(self):
        glm = self.dir / "gsplat/cuda/csrc/third_party/glm"
        glm.mkdir(parents=True)
        self.assertIn("clone gsplat with --recursive", self.bench.missing_submodule(self.dir))
        (glm / "glm").mkdir()
        self.assertIsNone(self.bench.missing_submodule(self.dir))

    def test_without_gsplat_it_says_so(self):
        done = subprocess.run([sys.executable, "-S", ROOT / "bench/gsplat_bench.py", self.dir, self.dir / "ours.json"],
                              capture_output=True, text=True, check=False)  # fmt: skip
        self.assertEqual(done.returncode, 1)
        self.assertIn("gsplat: not timed", done.stdout)


if __name__ == "__main__":
    unittest.main()

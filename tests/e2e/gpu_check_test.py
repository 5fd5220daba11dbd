#!/usr/bin/env python3
"""What of the GPU check needs no GPU: its order, its table, its exit code, and the line about gsplat. The tools are
stand-ins that are found before the machine's."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

BUILT = {
    "cuda_tests": 'echo "$STUB_TESTS"',
    "gpu_bench": """echo "the table"; echo '{"iteration_ms": 3.5, "forward_ms": 0.9, "training_bytes_per_gaussian": 790}' > "$2/ours.json" """,
    # reconstruct SCENE -o OUT --device DEVICE ...
    "oraclegs": """[ "$1" = demo-scene ] && exit 0
[ "$6" = cuda ] && psnr=$STUB_PSNR || psnr=30.00
mkdir -p "$4" && echo "{\\"test\\": {\\"psnr\\": $psnr}}" > "$4/metrics.json" """,
}
TOOLS = {
    "cmake": """[ "$1" = --build ] || exit 0
mkdir -p build/cuda/bin && cp "$STUB_BUILT"/* build/cuda/bin/""",
    "ninja": "",
    "nvcc": "",
    "g++": "",
    "pkg-config": "",
    "nvidia-smi": "echo a GPU",
    "compute-sanitizer": "",
    "python3": f"""case "$2" in *"import torch"*) echo "$STUB_TORCH"; exit 0 ;; *"import gsplat"*) exit 1 ;; esac
exec {sys.executable} "$@" """,
}


def write_programs(folder, programs):
    folder.mkdir(parents=True)
    for name, text in programs.items():
        (folder / name).write_text(f"#!/bin/bash\n{text}\n")
        (folder / name).chmod(0o755)


class GpuCheckTest(unittest.TestCase):
    def setUp(self):
        self.dir = Path(tempfile.mkdtemp(prefix="oraclegs_gpu_check_"))
        self.addCleanup(shutil.rmtree, self.dir)
        write_programs(self.dir / "tools", TOOLS)
        write_programs(self.dir / "built", BUILT)
        (self.dir / "scripts").mkdir()
        shutil.copy(ROOT / "scripts/gpu_check.sh", self.dir / "scripts")

    def check(self, tests="[  PASSED  ] 9 tests.", psnr="30.05", torch="2.11.0 CUDA 13.0 ABI 1"):
        environment = dict(os.environ, PATH=f"{self.dir}/tools:/usr/bin:/bin", STUB_BUILT=str(self.dir / "built"),
                           STUB_TESTS=tests, STUB_PSNR=psnr, STUB_TORCH=torch)  # fmt: skip
        return subprocess.run([self.dir / "scripts/gpu_check.sh"], capture_output=True, text=True, env=environment, timeout=60, check=False)

    def test_all_good(self):
        done = self.check()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("the table", done.stdout)
        for name in ("configure", "build", "tests", "benchmark", "demo_scene", "memcheck", "racecheck"):
            self.assertRegex(done.stdout, rf"(?m)^{name} +passed +\d+ s$")
        self.assertRegex(done.stdout, r"(?m)^gsplat +skipped +not installed; --gsplat PATH$")
        self.assertRegex(done.stdout, r"(?m)^iteration +good +3\.500 ms \(wanted: 4 ms on an H200\)$")
        self.assertRegex(done.stdout, r"(?m)^forward +MISSED +0\.900 ms")
        self.assertRegex(done.stdout.splitlines()[-1], r"^demo scene, PSNR +good +cpu 30\.000, cuda 30\.050 dB")

    def test_devices_that_disagree(self):
        done = self.check(psnr="30.20")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, r"demo scene, PSNR +MISSED +cpu 30\.000, cuda 30\.200 dB")

    def test_skipped_tests_are_no_success(self):
        done = self.check(tests="[  SKIPPED ] 3 tests.")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, r"(?m)^tests +FAILED")
        self.assertRegex(done.stdout, r"(?m)^benchmark +passed")  # the rest is told all the same

    def test_a_torch_that_will_not_do_is_told_before_anything_is_built(self):
        for torch, why in (("1.13 CUDA None ABI 1", "must be one with CUDA"), ("2.5.1 CUDA 12.4 ABI 0", "old C\\+\\+ ABI"),
                           ("", "cannot import torch")):  # fmt: skip
            done = self.check(torch=torch)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stdout, rf"torch +FAILED +.*{why}")
            self.assertNotIn("== configure", done.stdout)

    def test_other_words(self):
        done = subprocess.run([self.dir / "scripts/gpu_check.sh", "--gsplats"], capture_output=True, text=True, check=False)
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
        alone = self.bench.line("1.5", theirs, None)
        self.assertEqual(alone, "gsplat 1.5: forward 2.000 ms, backward 5.000 ms, iteration 9.000 ms")
        both = self.bench.line("1.5", theirs, {"forward_ms": 0.8, "iteration_ms": 3.0})
        self.assertIn("ours: forward 0.800 ms, 2.50 times as fast, iteration 3.000 ms, 3.00 times as fast", both)

    def test_reads_what_gpu_bench_wrote(self):
        (self.dir / "camera.txt").write_text("1237 822 1113.3 1138.04 617.2 411.7\n")
        self.assertEqual(self.bench.read_camera(self.dir), (1237, 822, [[1113.3, 0, 617.2], [0, 1138.04, 411.7], [0, 0, 1]]))
        self.assertIsNone(self.bench.read_ours(self.dir))
        (self.dir / "ours.json").write_text(json.dumps({"iteration_ms": 3}))
        self.assertEqual(self.bench.read_ours(self.dir), {"iteration_ms": 3})

    def test_without_gsplat_it_is_skipped(self):
        done = subprocess.run([sys.executable, "-S", ROOT / "bench/gsplat_bench.py", self.dir], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0)
        self.assertIn("gsplat: skipped", done.stdout)


if __name__ == "__main__":
    unittest.main()

"""The library of device code from the outside: a program without it, with one for an emulated GPU, and with a wrong one."""

import json
import os
import subprocess
import unittest
from pathlib import Path

from harness import PROGRAM, SMALL_RUN, EndToEnd, command, main

LIBRARIES = Path(PROGRAM).parent.parent / "lib"
EMULATED = LIBRARIES / "liboraclegs_cuda_emulated.so"
RUN = [*SMALL_RUN, "--iterations", 40, "--max-gaussians", 500, "--set", "random-points=400", "--no-report"]


def with_library(file):
    return {**os.environ, "ORACLEGS_CUDA_LIBRARY": str(file)}


class Cuda(EndToEnd):
    def test_without_the_library_a_gpu_is_refused_in_one_line(self):
        env = with_library("/nowhere/liboraclegs_cuda.so")
        self.error_of("reconstruct", self.scene, "-o", self.dir / "none", *RUN, "--device", "cuda", code=2,
                      names=["--device cuda", "--device cpu"], env=env)  # fmt: skip
        self.assertFalse((self.dir / "none").exists())
        self.assertIn("cuda       no: liboraclegs_cuda.so is not installed", self.run_program("--version", env=env).stdout)

    def test_another_library_is_named(self):
        env = with_library(LIBRARIES / "liboraclegs_core.so")
        self.error_of("train", self.scene, "-o", self.dir / "other", "--device", "cuda", code=2,
                      names=["liboraclegs_core.so: is no library of device code", "--device cpu"], env=env)  # fmt: skip
        done = self.run_program("train", self.scene, "-o", self.dir / "auto", *RUN, env=env)
        self.assertIn("computing on the CPU: ", done.stdout + done.stderr)
        self.assertIn("is no library of device code", done.stdout + done.stderr)

    @unittest.skipUnless(EMULATED.exists(), "built with nvcc: a GPU is not emulated")
    def test_a_whole_run_on_the_emulated_gpu_ends_as_on_the_cpu(self):
        psnr = {}
        for device in ("auto", "cpu"):
            out = self.dir / f"run_{device}"
            done = self.run_program("reconstruct", self.scene, "-o", out, *RUN, "--device", device, env=with_library(EMULATED))
            self.assertEqual("computing on the GPU cuda:0" in done.stdout + done.stderr, device == "auto")
            psnr[device] = json.loads((out / "metrics.json").read_text())["test"]["psnr"]
        self.assertAlmostEqual(psnr["auto"], psnr["cpu"], delta=0.3)
        picture = self.dir / "rendered"
        self.run_program("render", self.dir / "run_cpu", "-o", picture, "--device", "cuda", env=with_library(EMULATED))
        self.assertTrue(any(picture.rglob("*.png")))

    @unittest.skipUnless(EMULATED.exists(), "built with nvcc: a GPU is not emulated")
    def test_depth_and_proposals_on_the_emulated_gpu(self):
        out = self.dir / "proposed"
        done = subprocess.run(command("propose", self.scene, "-o", out, "--proposers", "warp", "--device", "cuda", "--set", "stereo-iterations=1",
                                      "--set", "stereo-passes=1"), capture_output=True, text=True, check=False, env=with_library(EMULATED))  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads((out / "stages.json").read_text())["depth"]["device"], "cuda:0")


if __name__ == "__main__":
    main()

"""The paper's pipeline from the outside, with small networks of random weights: every stage, its files, and what is told
where weights are missing."""

import json
import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

from harness import PROGRAM, ManyViews, command, files_below, main

TINY_NETWORKS = os.environ.get("ORACLEGS_TINY_NETWORKS", str(Path(PROGRAM).with_name("tiny_networks")))
MODELS = ["depth-anything-v2-small", "seva", "sd21-vae", "openclip-vith14", "vggt", "lpips-vgg"]
PRESETS = ["paper", "paper-mipnerf360-12", "paper-mipnerf360-24", "paper-blender-8", "best-mipnerf360-12"]
SMALL = ["--views", 10, "--test-every", 4, "--downscale", 1, "--set", "stereo-iterations=3", "--set", "stereo-passes=1",
         "--iterations", 20, "--max-gaussians", 1500, "--init", "hybrid", "--set", "proxy-models=3", "--proposals", 3, "--trajectory", "dataset",
         "--seva-frames", 12, "--seva-short-side", 64, "--set", "seva-steps=2", "--set", "candidates=2"]  # fmt: skip


class Networks(ManyViews):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.models = cls.dir / "models"
        subprocess.run([TINY_NETWORKS, cls.models], check=True)
        cls.with_models = {"env": os.environ | {"ORACLEGS_MODELS": str(cls.models)}}

    def test_a_preset_runs_the_whole_pipeline(self):
        out = self.dir / "whole"
        arguments = ["reconstruct", self.scene, "-o", out, "--preset", "best-mipnerf360-12", *SMALL]
        done = self.run_program(*arguments, **self.with_models)
        metrics = json.loads((out / "metrics.json").read_text())
        self.assertTrue({"sfm", "depth", "propose", "validate", "train", "evaluate"} <= metrics["stages"].keys())
        self.assertEqual(metrics["depth"]["prior"], "fused")
        self.assertIn("lpips", metrics["test"])
        self.assertEqual(metrics["non_commercial"], ["Stable Virtual Camera", "VGGT-1B"])
        self.assertIn("not for commercial use: made with Stable Virtual Camera, VGGT-1B", done.stdout)
        self.assertIn(b"made with Stable Virtual Camera\n", (out / "point_cloud.ply").read_bytes()[:1000])
        frames = json.loads((out / "proposals/transforms.json").read_text())["frames"]
        self.assertEqual(len(frames), 3)
        for frame in frames:
            for folder in ("proposals", "proposals/seva", "proposals/seva_2", "confidence"):
                self.assertTrue((out / folder / frame["file_path"]).is_file(), folder)
        self.assertFalse((out / "proposals/warp").exists())
        self.assertFalse((out / "proposals/seva_chunks").exists())
        self.assertRegex(self.run_program(*arguments, **self.with_models).stdout, "(?m)^propose .*unchanged")

    def test_the_papers_preset_runs(self):
        out = self.dir / "paper"
        small = ["--views", 10, "--test-every", 4, "--downscale", 1, "--iterations", 20, "--max-gaussians", 1500, "--init",
                 "random-cube", "--seva-frames", 12, "--seva-short-side", 64, "--set", "seva-steps=2"]  # fmt: skip
        arguments = ["reconstruct", self.scene, "-o", out, "--preset", "paper-mipnerf360-12", *small]
        self.run_program(*arguments, **self.with_models)
        frames = json.loads((out / "proposals/transforms.json").read_text())["frames"]
        self.assertEqual(len(frames), 5, "every view that neither trains nor tests")
        metrics = json.loads((out / "metrics.json").read_text())
        self.assertEqual(metrics["depth"]["prior"], "depth-anything")
        self.assertEqual(metrics["options"]["horizon"], 30000)
        # Its oracle's confidence is relative, so that some of what networks of random weights paint is trained on.
        self.assertIn("VGG16", metrics["train"]["lpips"])

    def test_the_papers_preset_for_own_photos_finds_the_poses(self):
        scene, photos, out = self.dir / "textured", self.dir / "photos", self.dir / "own"
        size = ["--demo-views", 9, "--width", 320, "--height", 240, "--samples", 1]
        subprocess.run(command("demo-scene", scene, "--quiet", *size), check=True)
        photos.mkdir()
        for photo in (scene / "images").glob("*.png"):
            shutil.copy(photo, photos)
        small = ["--iterations", 20, "--max-gaussians", 1500, "--proposals", 4, "--seva-frames", 12, "--seva-short-side", 64,
                 "--set", "seva-steps=2"]  # fmt: skip
        self.run_program("reconstruct", photos, "-o", out, "--preset", "paper", *small, **self.with_models)
        metrics = json.loads((out / "metrics.json").read_text())
        self.assertEqual(metrics["non_commercial"], ["Stable Virtual Camera", "VGGT-1B"])
        self.assertEqual((metrics["test"]["views"], metrics["depth"]["prior"]), ([], "depth-anything"))
        frames = json.loads((out / "proposals/transforms.json").read_text())["frames"]
        self.assertEqual(len(frames), 4)
        self.assertEqual(json.loads((out / "stages.json").read_text())["start"]["source"], "sfm")

    def test_what_a_preset_of_a_dataset_says_of_other_scenes(self):
        out = self.dir / "refused"
        arguments = ["-o", out, "--preset", "paper-mipnerf360-12"]
        self.error_of("reconstruct", self.scene, *arguments, code=3,
                      names=["has no folder images_4", "--set smaller-copies=auto"], **self.with_models)  # fmt: skip
        two = self.dir / "two"
        two.mkdir()
        for photo in sorted((self.scene / "images").glob("*.png"))[:2]:
            shutil.copy(photo, two)
        whole = ["--set", "smaller-copies=auto", "--downscale", 1]
        self.error_of("reconstruct", two, *arguments, *whole, code=3,
                      names=["--views asks for 12 training views, but only 1 is left beside 1 test view"], **self.with_models)  # fmt: skip
        done = self.run_program("reconstruct", self.scene, *arguments, *whole, "--views", 24, code=3, **self.with_models)
        self.assertIn("--preset paper-mipnerf360-12 is made for 12 views; with --views 24 its other settings stay as they are, "
                      "--iterations among them; --preset paper-mipnerf360-24 has those for 24\n", done.stderr)  # fmt: skip
        done = self.run_program("reconstruct", self.scene, *arguments, *whole, "--views", 9, "--device", "tpu", code=2)
        self.assertNotIn("is made for 12 views", done.stderr, "bad options come first")
        self.assertFalse(out.exists())

    def test_large_networks_are_left_to_a_gpu(self):
        out, models = self.dir / "on_a_cpu", self.dir / "large"
        shutil.copytree(self.models, models)
        env = {"env": os.environ | {"ORACLEGS_MODELS": str(models), "CUDA_VISIBLE_DEVICES": ""}}
        arguments = ["reconstruct", self.scene, "-o", out, "--preset", "paper", *SMALL]
        for model, asked in (("vggt", "--oracle vggt: VGGT"), ("seva", "--proposers seva: Stable Virtual Camera")):
            numbers = 300_000_000  # a hole in the file
            header = json.dumps({"x": {"dtype": "F32", "shape": [numbers], "data_offsets": [0, 4 * numbers]}}).encode()
            with open(models / model / "model.safetensors", "wb") as file:
                file.write(len(header).to_bytes(8, "little") + header)
                file.truncate(8 + len(header) + 4 * numbers)
            self.error_of(*arguments, code=2, names=[f"{asked} would compute on the CPU", "NVIDIA GPU", "--device cpu"], **env)
        self.assertFalse(out.exists())

    def test_too_little_is_told_before_anything_is_computed(self):
        out = self.dir / "too_many"
        many = ["--views", 0, "--seva-frames", 12, "--seva-short-side", 64, "--set", "seva-steps=2"]
        self.error_of("reconstruct", self.scene, "-o", out, "--preset", "paper", *many, code=2,
                      names=["20 photos leave no room in chunks of 12 frames", "--seva-frames must be at least 22"],
                      **self.with_models)  # fmt: skip
        # No machine has the memory for so much at once.
        huge = ["--seva-frames", 1000, "--seva-short-side", 4096, "--set", "seva-halves=batched"]
        self.error_of("reconstruct", self.scene, "-o", out, "--preset", "paper", *huge, code=4,
                      names=["seva needs about", "less is needed with --set seva-halves=in-turn"], **self.with_models)  # fmt: skip
        self.assertFalse(out.exists())

    def test_three_images_and_no_depth_are_enough_for_a_generator(self):
        out = self.dir / "three"
        self.run_program("reconstruct", self.scene, "-o", out, *SMALL, "--views", 3, "--proposers", "seva", "--set",
                         "candidates=1", "--depth-prior", "none", "--init", "random", "--oracle", "vggt", "--set", "calibrate=false",
                         **self.with_models)  # fmt: skip
        self.assertEqual(len(list((out / "confidence").glob("*.png"))), 3)

    def test_layers_of_the_oracle_are_options(self):
        out = self.dir / "layers"
        arguments = ["validate", self.scene, "-o", out, *SMALL, "--proposers", "warp", "--oracle", "vggt", "--set", "calibrate=false"]
        self.run_program(*arguments, **self.with_models)
        usual = files_below(out / "confidence")
        self.run_program(*arguments, "--set", "vggt-layers=1", "--overwrite", **self.with_models)
        of_one = files_below(out / "confidence")
        self.assertEqual(usual.keys(), of_one.keys())
        self.assertNotEqual([usual[name][0] for name in usual], [of_one[name][0] for name in usual])
        for bad, code, names in (
            (["--set", "vggt-layers=0,99"], 2, ["99"]),
            (["--set", "vggt-layers=0", "--set", "vggt-layer-weights=1,2"], 2, ["--set vggt-layer-weights"]),
            (["--set", "vggt-layers=first"], 2, ["'first'"]),
        ):
            self.error_of(*arguments, *bad, "-o", self.dir / "refused", code=code, names=names, **self.with_models)
            self.assertFalse((self.dir / "refused").exists())

    def test_a_sweep_of_layers_measures_each(self):
        out = self.dir / "sweep"
        arguments = ["validate", self.scene, "-o", out, "--each-layer", *SMALL, "--proposers", "warp"]
        done = self.run_program(*arguments, **self.with_models)
        self.assertRegex(done.stdout, r"(?m)^as combined +0\.\d{3} ")
        layers = json.loads((out / "layers.json").read_text())["layers"]
        self.assertEqual([row["layer"] for row in layers], [None, *range(len(layers) - 1)])
        self.assertGreater(len(layers), 2)
        self.assertIn("<svg", (out / "layers.svg").read_text())
        self.error_of(*arguments, "--oracle", "uniform", code=2, names=["--oracle"], **self.with_models)

    def test_without_weights_all_that_is_missing_is_named(self):
        out = self.dir / "missing"
        for preset in PRESETS:
            error = self.error_of("reconstruct", self.scene, "-o", out, "--preset", preset, "--downscale", 1, code=3)
            self.assertEqual(re.findall(r"`oraclegs models fetch ([^`]*)`", error), MODELS)
            self.assertIn("--allow-fallback", error)
        self.assertFalse(out.exists())
        (self.models / "vggt/model.safetensors").rename(self.models / "vggt.moved")
        self.addCleanup((self.models / "vggt.moved").rename, self.models / "vggt/model.safetensors")
        error = self.error_of("sfm", self.scene, "-o", out, "--preset", PRESETS[0], "--downscale", 1, code=3, **self.with_models)
        self.assertEqual(re.findall(r"models fetch ([^`]*)`", error), ["vggt"])

    def test_a_fallback_runs_what_needs_no_weights_and_says_so(self):
        out = self.dir / "fallback"
        arguments = ["reconstruct", self.scene, "-o", out, "--preset", "best-mipnerf360-24", *SMALL, "--allow-fallback"]
        done = self.run_program(*arguments)
        for instead in ("--proposers proxies", "--oracle consistency", "--depth-prior stereo", "L1 and SSIM"):
            self.assertRegex(done.stderr, f"are not here; {instead}.* instead")
        self.assertEqual(json.loads((out / "metrics.json").read_text())["non_commercial"], [])
        options = json.loads((out / "options.json").read_text())["options"]
        self.assertEqual((options["proposers"], options["oracle"]), ("proxies", "consistency"))
        self.run_program("evaluate", out)

    def test_without_the_library_networks_are_refused_and_the_rest_works(self):
        out = self.dir / "no_library"
        env = self.with_models["env"] | {"ORACLEGS_NETWORKS_LIBRARY": "/nowhere/liboraclegs_networks.so"}
        for arguments, asked in (
            (["--oracle", "vggt"], "--oracle vggt"),
            (["--depth-prior", "fused"], "--depth-prior fused"),
            (["--proposers", "seva"], "--proposers seva"),
        ):
            error = self.error_of("reconstruct", self.scene, "-o", out, *SMALL, *arguments, code=2, env=env)
            self.assertIn(f"{asked} needs networks", error)
        done = self.run_program("reconstruct", self.scene, "-o", out, *SMALL, "--proposers", "warp", env=env)
        self.assertIn("without VGGT", done.stderr + done.stdout)
        self.assertNotIn("lpips", json.loads((out / "metrics.json").read_text())["test"])


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""The command line as a user meets it: help, documents, options from files, and the main job with its files."""

import json
import re
import struct
import subprocess
import unittest

from harness import ROOT, SMALL_RUN, EndToEnd, command, files_below, main

COMMANDS = ["reconstruct", "sfm", "depth", "train", "evaluate", "ablate", "render", "figure", "export", "mesh", "view", "info", "models", "demo-scene"]

# Where each command's options are declared, below src/oraclegs.
RUN_OPTIONS = ["pipeline/settings/options.h", "scene/split.h", "scene/loaded_view.h", "depth/stereo.h", "train/options.h",
               "propose/options.h", "propose/trajectory.h", "validate/options.h"]
DECLARED_IN = {
    **{name: RUN_OPTIONS for name in ["reconstruct", "sfm", "depth", "train", "evaluate"]},
    "ablate": RUN_OPTIONS + ["experiments/ablation.h"],
    "render": RUN_OPTIONS + ["pipeline/render_path.h"],
    "figure": RUN_OPTIONS + ["report/figure.h"],
    "export": ["pipeline/export.h"],
    "mesh": RUN_OPTIONS + ["mesh/fuse_model.h"],
    "demo-scene": ["demo/demo_scene.h"],
    "view": ["web/viewer_options.h"],
    "info": [],
    "models": ["weights/fetch.h"],
}


def declared_options(headers):
    for header in headers:
        yield from re.findall(r'visit\("([a-z-]+)"', (ROOT / "src/oraclegs" / header).read_text())


class Help(unittest.TestCase):
    def help_of(self, *arguments):
        return subprocess.run(command(*arguments, "--help"), check=True, capture_output=True, text=True).stdout

    def test_lists_every_command(self):
        text = self.help_of()
        for name in COMMANDS:
            self.assertIn(name, text)

    def test_every_command_tells_every_option_with_default_and_an_example(self):
        for name in COMMANDS:
            text = self.help_of(name)
            flat = " ".join(text.split())
            for option in declared_options(DECLARED_IN[name]):
                self.assertRegex(flat, rf"--{option}\b[^\[]*\[[^\]]*default", f"{name} --{option}")
            self.assertIn("Example:", text)
            self.assertIn(f"oraclegs {name}", text)
            self.assertLess(max(map(len, text.splitlines())), 121)

    def test_version(self):
        text = subprocess.run(command("--version"), check=True, capture_output=True, text=True).stdout
        self.assertRegex(text, r"^oraclegs \d+\.\d+\.\d+\n$")

    def test_documents_name_every_preset(self):
        pages = (ROOT / "docs/tutorial.md").read_text() + (ROOT / "docs/commands.md").read_text()
        for preset in (ROOT / "presets").glob("*.toml"):
            self.assertIn(f"`{preset.stem}`", pages)

    def test_program_links_no_libtorch(self):
        program = command("--version")[0]
        libraries = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
        self.assertIn("liboraclegs_core", libraries)
        for name in ["libtorch", "libc10", "openblas"]:  # not "c10", which addresses may hold
            self.assertNotIn(name, libraries)


class Usage(EndToEnd):
    def test_mistakes_on_the_command_line_end_with_2(self):
        out = self.dir / "usage_out"
        self.error_of(code=2)
        self.error_of("frobnicate", code=2, names=["frobnicate"])
        self.error_of("reconstruct", code=2, names=["scene"])
        self.error_of("reconstruct", self.scene, code=2, names=["-o"])
        self.error_of("reconstruct", self.scene, "-o", out, "--iterationz", "5", code=2, names=["iterationz"])
        self.error_of("reconstruct", self.scene, "-o", out, "--views", "many", code=2, names=["views", "many"])
        self.error_of("reconstruct", self.scene, "-o", out, "--views", "-3", code=2, names=["--views is -3", "0 .. "])
        self.error_of("reconstruct", self.scene, "-o", out, "--ssim-weight", "nan", code=2, names=["--ssim-weight"])
        self.error_of("reconstruct", self.scene, "-o", out, "--iterations", "99999999999", code=2, names=["iterations"])
        self.error_of("reconstruct", self.scene, "-o", out, "--background", "pink", code=2, names=["pink", "white"])
        self.error_of("reconstruct", self.scene, "-o", out, "--preset", "fast", code=2, names=["fast", "quick"])
        self.error_of("evaluate", self.scene, code=2, names=["--ply"])
        self.assertFalse(out.exists())

    def test_mistakes_in_a_configuration_file_end_with_2_and_name_it(self):
        file = self.dir / "bad.toml"
        for text, names in [("iterationz = 5\n", ["iterationz"]), ('views = "many"\n', ["many"]),
                            ("views = 3\nviews = 4\n", ["views"]), ("[train]\niterations = 5\n", ["train"]),
                            ('background = "white\n', ["background"]), ("views = [1, 2]\n", ["views"]),
                            ("just words\n", ["just words"])]:  # fmt: skip
            file.write_text(text)
            with self.subTest(text):
                arguments = ["reconstruct", self.scene, "-o", self.dir / "x", "--config", file]
                self.error_of(*arguments, code=2, names=[file, *names])
        self.error_of("info", self.scene, "--config", self.dir / "none.toml", code=2, names=["none.toml"])

    def test_config_and_flags_mean_the_same_and_flags_win(self):
        file = self.dir / "good.toml"
        file.write_text('# a comment\niterations = 20\nmax-gaussians = 900\nbackground = "white"\nantialiased = true\n'
                        'test-views = "000,001"\ninit = "random"\nrandom-points = 500\n')  # fmt: skip
        names = sorted(p.stem for p in (self.scene / "images").glob("*.png"))[:2]
        flags = ["--iterations", 20, "--max-gaussians", 900, "--background", "white", "--antialiased",
                 "--test-views", ",".join(names), "--init", "random", "--random-points", 500]  # fmt: skip
        file.write_text(file.read_text().replace("000,001", ",".join(names)))
        by_file, by_flags, mixed = (self.dir / name for name in ("by_file", "by_flags", "mixed"))
        self.run_program("train", self.scene, "-o", by_file, "--config", file)
        self.run_program("train", self.scene, "-o", by_flags, *flags)
        self.assertEqual((by_file / "options.json").read_text(), (by_flags / "options.json").read_text())
        self.assertEqual((by_file / "point_cloud.ply").read_bytes(), (by_flags / "point_cloud.ply").read_bytes())

        arguments = ["--config", file, "--preset", "quick", "--iterations", 7, "--no-antialiased"]
        self.run_program("sfm", self.scene, "-o", mixed, *arguments)
        options = json.loads((mixed / "options.json").read_text())["options"]
        self.assertEqual(options["iterations"], 7)  # the command line before the file
        self.assertFalse(options["antialiased"])
        self.assertEqual(options["max-gaussians"], 900)  # the file before the preset
        self.assertEqual(options["downscale"], 2)  # the preset before the default

    def test_presets_are_read(self):
        for preset in (ROOT / "presets").glob("*.toml"):
            scene = ["--train-views", ":1,:2,:3", "--test-views", ":0", "--views", 2, "--init", "random", "--random-points", 100, "--allow-fallback",
                     "--smaller-copies", "auto"]
            self.run_program("sfm", self.scene, "-o", self.dir / preset.stem, "--preset", preset.stem, *scene)


class MainJob(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.before = files_below(cls.scene)
        cls.out = cls.dir / "out"
        arguments = command("reconstruct", cls.scene, "-o", cls.out, *SMALL_RUN)
        cls.done = subprocess.run(arguments, capture_output=True, text=True, check=True)

    def test_writes_every_file(self):
        options = json.loads((self.out / "options.json").read_text())
        self.assertEqual(options["scene"], str(self.scene.resolve()))
        self.assertEqual(options["options"]["iterations"], 200)
        split = json.loads((self.out / "split.json").read_text())
        self.assertEqual((len(split["train"]), len(split["test"])), (6, 2))
        pictures = sorted(p.name for p in (self.out / "renders/test").glob("*.png"))
        self.assertEqual(len(pictures), 4)
        self.assertEqual(sum(name.endswith("_gt.png") for name in pictures), 2)
        self.assertEqual([p for p in self.out.rglob("*.tmp")], [])

    def test_metrics_have_the_agreed_keys(self):
        metrics = json.loads((self.out / "metrics.json").read_text())
        split = json.loads((self.out / "split.json").read_text())
        self.assertGreater(metrics["test"]["psnr"], 12)
        self.assertTrue(0 < metrics["test"]["ssim"] < 1)
        self.assertEqual([view["name"] for view in metrics["test"]["views"]], split["test"])
        for view in metrics["test"]["views"]:
            self.assertIsInstance(view["psnr"], float)
            self.assertIsInstance(view["ssim"], float)
        for stage in ["train", "evaluate"]:
            self.assertGreaterEqual(metrics["stages"][stage]["seconds"], 0)
        self.assertEqual(metrics["start"], {"source": "random", "points": 1500})
        self.assertEqual(metrics["train"]["iterations"], 200)
        self.assertGreater(metrics["train"]["iterations_per_second"], 0)
        self.assertTrue(0 < metrics["gaussians"] <= 2000)
        self.assertGreater(metrics["peak_memory_bytes"], 1 << 20)
        self.assertRegex(metrics["version"], r"^\d+\.\d+\.\d+$")
        self.assertEqual(metrics["options"]["max-gaussians"], 2000)
        self.assertEqual(metrics["seed"], 0)

    def test_the_ply_is_what_viewers_read(self):
        data = (self.out / "point_cloud.ply").read_bytes()
        header = data[: data.index(b"end_header\n") + 11].decode()
        gaussians = json.loads((self.out / "metrics.json").read_text())["gaussians"]
        self.assertTrue(header.startswith("ply\nformat binary_little_endian 1.0\n"))
        self.assertIn(f"element vertex {gaussians}\n", header)
        names = re.findall(r"property float (\w+)\n", header)
        for name in ["x", "y", "z", "f_dc_0", "f_rest_44", "opacity", "scale_2", "rot_3"]:
            self.assertIn(name, names)
        values = struct.unpack(f"<{gaussians * len(names)}f", data[len(header) :])
        self.assertTrue(all(abs(v) < 1e6 for v in values))

    def test_tells_what_happens_in_plain_lines_and_ends_with_a_summary(self):
        self.assertNotIn("\r", self.done.stderr)
        self.assertIn("6 training views: ", self.done.stderr)
        self.assertIn("PSNR", self.done.stdout)
        self.assertIn(str(self.out / "point_cloud.ply"), self.done.stdout)

    def test_the_scene_is_untouched_and_nothing_is_done_twice(self):
        before = files_below(self.out)
        again = self.run_program("reconstruct", self.scene, "-o", self.out, *SMALL_RUN)
        after = files_below(self.out)
        self.assertNotIn("train: started", again.stderr)
        for name in ["point_cloud.ply", "metrics.json"]:
            self.assertEqual(before[name], after[name])
        self.assertEqual(files_below(self.scene), self.before)

    def test_quiet_says_nothing(self):
        done = self.run_program("reconstruct", self.scene, "-o", self.out, "--quiet", *SMALL_RUN)
        self.assertEqual(done.stdout + done.stderr, "")

    def test_other_commands_work_on_the_workspace(self):
        self.assertIn("PSNR", self.run_program("evaluate", self.out).stdout)
        small = self.dir / "small.ply"
        self.run_program("export", self.out, "-o", small, "--sh-degree", 1, "--min-opacity", 0.1)
        self.assertLess(small.stat().st_size, (self.out / "point_cloud.ply").stat().st_size)
        info = json.loads(self.run_program("info", small, "--json").stdout)
        self.assertEqual(info["sh_degree"], 1)
        self.assertIn("Gaussians", self.run_program("info", self.out).stdout)
        self.assertIn("transforms.json", self.run_program("info", self.scene).stdout)

        scores = self.dir / "scores"
        self.run_program("evaluate", self.scene, "--ply", small, "-o", scores, "--test-every", 4)
        self.assertEqual(len(json.loads((scores / "metrics.json").read_text())["test"]["views"]), 2)
        self.assertIn("PSNR", self.run_program("evaluate", self.out, "--ply", small).stdout)
        unscored = self.run_program("evaluate", self.scene, "--ply", small, "--test-every", 0).stdout
        self.assertIn("no test pixels", unscored)

        self.run_program("render", self.out, "--path", "orbit", "--frames", 3)
        self.assertEqual(len(list((self.out / "renders/orbit").glob("*.png"))), 3)
        arguments = ["--path", "train", "-o", self.dir / "train", "--no-video"]
        self.run_program("render", self.scene, "--ply", small, *arguments)
        self.assertEqual(len(list((self.dir / "train").glob("*.png"))), 7)

    def test_starts_from_triangulated_points_where_colmap_gives_them(self):
        out = self.dir / "sfm_out"
        arguments = ["--init", "auto", "--iterations", 20, "--max-gaussians", 1000, "--random-points", 1000]
        done = self.run_program("reconstruct", self.scene, "-o", out, *arguments)
        start = json.loads((out / "metrics.json").read_text())["start"]
        if start["source"] == "random":  # no colmap, or too few points: then it must have been said
            self.assertIn("warning", done.stderr)
        else:
            self.assertGreaterEqual(start["points"], 100)

    def test_depth_leaves_pictures_and_a_cloud_that_training_starts_from(self):
        out = self.dir / "depth_out"
        arguments = ["-o", out, "--init", "dense", "--stereo-iterations", 2, "--max-gaussians", 1000]
        done = self.run_program("depth", self.scene, *arguments)
        training = json.loads((out / "split.json").read_text())["train"]
        for name in training:
            self.assertRegex(done.stdout, rf"(?m)^{re.escape(name)} +[0-9.]+ % confident$")
            for folder in ["", "confidence", "normals", "preview"]:
                picture = (out / "depth" / folder / name.replace("/", "_")).with_suffix(".png")
                self.assertTrue(picture.is_file(), picture)
        self.assertEqual(len(json.loads((out / "depth/depth_params.json").read_text())), len(training))
        self.assertTrue((out / "sfm/dense.ply").read_bytes().startswith(b"ply\nformat binary_little_endian 1.0\n"))
        before = files_below(out / "depth")
        self.run_program("train", self.scene, *arguments, "--iterations", 5)
        self.assertEqual(files_below(out / "depth"), before, "found once")
        stages = json.loads((out / "stages.json").read_text())
        self.assertEqual(stages["start"]["source"], "dense")


if __name__ == "__main__":
    main()

"""The benchmark of suites from the outside: its tables, its files, what a second call does, what it refuses."""

import json
import os
import shlex
import unittest

from harness import EndToEnd, files_below, main, png, read_png

SCENES = ("garden", "room")

RUN = ["--set", "stereo-iterations=3", "--set", "stereo-passes=1", "--iterations", 20, "--max-gaussians", 1000, "--set",
       "random-points=800", "--init", "random", "--test-every", 4]  # fmt: skip


class Bench(EndToEnd):
    def suite(self):
        folder = self.dir / "my suite"
        for name in ("one", "two"):
            if not (folder / name).exists():
                self.copy_scene(f"my suite/{name}")
        return folder

    def test_runs_a_folder_of_scenes_and_writes_tables(self):
        out = self.dir / "a bench"
        arguments = ["bench", "--suite", self.suite(), "-o", out, "--views", "3,4", "--seeds", 1, "--methods",
                     "ours,ours-no-proposals", *RUN]  # fmt: skip
        done = self.run_program(*arguments)
        self.assertRegex(done.stdout, r"(?m)^one +OracleGS \(this program\) +\d+\.\d\d +0\.\d{4} +- ")
        self.assertRegex(done.stderr, r"run 1 of 8 \(my suite-one-3-ours-seed0\): \d+\.\d\d dB, about [0-9:]+ left")
        report = json.loads((out / "bench.json").read_text())
        self.assertEqual((report["scenes"], report["views"], report["seeds"]), (["one", "two"], [3, 4], [0]))
        for run in report["runs"]:
            metrics = json.loads((out / run["workspace"] / "metrics.json").read_text())
            self.assertEqual((metrics["test"]["psnr"], metrics["seed"]), (run["psnr"], run["seed"]))
            self.assertEqual(metrics["views"]["train"], run["views"])
            self.assertGreaterEqual(run["peak_bytes"], metrics["peak_memory_bytes"])
            self.assertFalse((out / run["workspace"] / "checkpoints").exists())
        depth = [files_below(out / f"runs/my suite-one-3-{method}-seed0/depth") for method in ("ours", "ours-no-proposals")]
        self.assertEqual(*[{name: data for name, (data, _) in files.items()} for files in depth], "shared")
        for name in ("bench.md", "bench.tex", "bench.csv", "bench-views.svg", "bench-time.svg"):
            self.assertTrue((out / name).read_text().strip(), name)

        self.run_program("figure", out, "-o", self.dir / "grid", "--panel-width", 96)
        width, height = read_png(self.dir / "grid.png")[:2]
        self.assertEqual(width, 8 + 3 * 96 + 2 * 6 + 8, "the photo and two methods")
        self.assertGreater(height, 4 * 72, "two scenes, two numbers of views")
        self.error_of("figure", out, out, "-o", self.dir / "refused", code=2, names=["benchmark"])

        runs = files_below(out / "runs")
        self.assertEqual(self.run_program(*arguments).stdout, done.stdout)
        self.assertEqual(files_below(out / "runs"), runs, "nothing is run again")
        self.error_of(*arguments, "--iterations", 30, code=3, names=["--iterations was 20, now is 30", "--overwrite"])

    def test_dry_run_runs_nothing(self):
        out = self.dir / "never"
        done = self.run_program("bench", "--suite", self.suite(), "-o", out, "--views", 3, "--seeds", 1, "--dry-run")
        self.assertIn("one, 3 views: 3 training images (", done.stdout)
        self.assertIn("96x72 pixels", done.stdout)
        self.assertEqual(done.stdout.count(" reconstruct "), 4)
        self.assertFalse(out.exists())

    def test_bad_input(self):
        out = self.dir / "refused"
        self.error_of("bench", "-o", out, code=2, names=["--suite is missing"])
        self.error_of("bench", "--suite", "blendr", "-o", out, code=2, names=["did you mean 'blender'"])
        self.error_of("bench", "--suite", "blender", "-o", out, code=2, names=["--data is missing"])
        self.error_of("bench", "--suite", "llff", "--data", self.dir, "-o", out, code=3, names=["no scene of LLFF"])
        suite = ["bench", "--suite", self.suite()]
        self.error_of(*suite, code=2, names=["-o"])
        self.error_of(*suite, "-o", out, "--methods", "magic", code=2, names=["'magic'", "3dgs-mcmc"])
        self.error_of(*suite, "-o", out, "--views", "many", code=2, names=["'many'"])
        self.error_of(*suite, "-o", self.suite() / "one/out", code=3, names=["one"])
        self.assertFalse(out.exists())


class PaperTables(EndToEnd):
    """Tables 1 and 3 of the paper, as commands: what would be run on scenes that look like Mip-NeRF 360."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.data = cls.dir / "datasets"
        names = [f"{i:03}.png" for i in range(30)]
        for folder, side in (("images", 2800), ("images_4", 700)):
            blank = cls.dir / f"{folder}.png"
            blank.write_bytes(png(side, side, (0, 0, 0)))
            for scene in SCENES:
                (cls.data / scene / folder).mkdir(parents=True)
                for name in names:
                    os.link(blank, cls.data / scene / folder / name)
        for scene in SCENES:
            model = cls.data / scene / "sparse/0"
            model.mkdir(parents=True)
            (model / "cameras.txt").write_text("1 PINHOLE 2800 2800 2600 2600 1400 1400\n")
            poses = [f"{i + 1} 1 0 0 0 {0.1 * i} 0 0 1 {name}\n\n" for i, name in enumerate(names)]
            (model / "images.txt").write_text("".join(poses))
            (model / "points3D.txt").write_text("")

    def commands(self, *arguments):
        done = self.run_program(*arguments, "--dry-run", "-o", self.dir / "never")
        self.assertFalse((self.dir / "never").exists())
        return [shlex.split(line) for line in done.stdout.splitlines() if " reconstruct " in line], done.stdout

    def test_the_method_paper_follows_the_number_of_views(self):
        bench = ["bench", "--suite", "mipnerf360", "--data", self.data, "--seeds", 1]
        commands, text = self.commands(*bench, "--methods", "paper,ours,3dgs")
        self.assertEqual(len(commands), 2 * 2 * 3)
        self.assertIn("garden, 24 views: 24 training images", text)
        self.assertIn("bicycle: is missing", text.replace(str(self.data) + "/", ""))
        for words in commands:
            views = words[words.index("--views") + 1]
            is_paper = f"{views}-paper-seed0" in " ".join(words)
            iterations = words[words.index("--iterations") + 1] if "--iterations" in words else ""
            self.assertEqual("horizon=30000" in words and "oracle-pass=all" in words, is_paper)
            if is_paper:
                self.assertEqual(iterations, {"12": "15000", "24": "22000"}[views])
            elif "-3dgs-" in " ".join(words):
                self.assertNotIn(iterations, ("15000", "22000"))
            self.assertIn("smaller-copies=required", words)
        self.error_of(*bench, "--methods", "paper", "--views", "12,16", "-o", self.dir / "never", "--dry-run", code=2,
                      names=["12 and 24 views, not of 16"])  # fmt: skip
        self.error_of(*bench, "--preset", "paper-mipnerf360-12", "--views", "12,24", "-o", self.dir / "never", "--dry-run",
                      code=2, names=["--views names 24", "--preset"])  # fmt: skip
        self.error_of(*bench, "--preset", "paper", "-o", self.dir / "never", "--dry-run", code=2, names=["--methods paper"])
        commands, _ = self.commands(*bench, "--preset", "paper-mipnerf360-12", "--methods", "ours,3dgs")
        self.assertEqual(["horizon=30000" in words for words in commands], [True, False] * 2)

    def test_the_ablation_of_a_suite(self):
        ablate = ["ablate", self.data, "--suite", "mipnerf360", "--rows", "mcmc,union,schedule", "--seeds", 1]
        commands, text = self.commands(*ablate, "--preset", "paper")
        self.assertEqual(len(commands), 2 * 2 * 3)
        for words in commands:
            views = words[words.index("--views") + 1]
            self.assertIn(f"/{views}-views/", words[words.index("--out") + 1])
            self.assertEqual(words[words.index("--iterations") + 1], {"12": "15000", "24": "22000"}[views])
            self.assertEqual("--proposers none" in " ".join(words), "/01-mcmc/" in " ".join(words))
        commands, _ = self.commands(*ablate, "--views", 24)
        self.assertTrue(all("horizon=30000" not in words for words in commands))
        self.assertEqual({words[words.index("--views") + 1] for words in commands}, {"24"})
        out = ["-o", self.dir / "never"]
        self.error_of(*ablate, *out, "--also", self.scene, code=2, names=["--also", "--suite"])
        self.error_of(*ablate, *out, "--preset", "paper-mipnerf360-24", "--views", 12, code=2, names=["names 12", "24"])
        self.error_of("ablate", self.scene, *out, "--suite", "blender", code=3, names=["no scene of Blender"])


if __name__ == "__main__":
    main()

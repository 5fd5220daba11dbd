"""The benchmark of suites from the outside: its tables, its files, what a second call does, what it refuses."""

import json
import unittest

from harness import EndToEnd, files_below, main, read_png

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


if __name__ == "__main__":
    main()

"""Proposals and their confidence from the outside: files, messages, what is refused."""

import json
import unittest

from harness import ManyViews, files_below, main, png

RUN = ["--views", 10, "--test-every", 4, "--set", "stereo-iterations=3", "--set", "stereo-passes=1", "--iterations", 20,
       "--max-gaussians", 1500, "--set", "proxy-models=3", "--trajectory", "dataset"]  # fmt: skip


class Propose(ManyViews):
    def names(self, out):
        return {part: json.loads((out / "split.json").read_text())[part] for part in ("train", "test")}

    def test_stages_leave_files_and_reconstruct_uses_them(self):
        out = self.dir / "out"
        self.run_program("propose", self.scene, "-o", out, *RUN)
        frames = json.loads((out / "proposals/transforms.json").read_text())["frames"]
        self.assertEqual(len(frames), 5)
        proposed = self.run_program("validate", self.scene, "-o", out, *RUN).stdout
        used = {name.replace("/", "_").rsplit(".", 1)[0] for part in self.names(out).values() for name in part}
        for frame in frames:
            name = frame["file_path"].removesuffix(".png")
            self.assertNotIn(name, used)
            self.assertRegex(proposed, rf"(?m)^{name} +mean confidence [0-9.]+$")
            for folder in ("proposals", "proposals/proxies", "confidence"):
                self.assertTrue((out / folder / f"{name}.png").is_file(), folder)
            self.assertTrue((out / "confidence/preview" / f"{name}.jpg").is_file())
        before = files_below(out / "proposals") | files_below(out / "confidence")
        self.run_program("reconstruct", self.scene, "-o", out, *RUN)
        self.assertEqual(files_below(out / "proposals") | files_below(out / "confidence"), before, "made once")
        stages = json.loads((out / "metrics.json").read_text())["stages"]
        self.assertTrue({"depth", "propose", "validate", "train"} <= stages.keys())

        self.assertIn("blocks of 8 x 8: AUROC", self.run_program("evaluate", out, "--check-oracle").stdout)
        report = json.loads((out / "oracle.json").read_text())
        self.assertEqual(report["views"], 5)
        self.assertGreater(report["oracle"]["auroc_large_error"], 0.6)  # of a model of 6 iterations
        self.assertEqual(report["uniform"]["auroc_large_error"], 0.5)
        self.assertEqual(report["oracle"]["blocks"]["blocks"], 5 * 80)

        table = self.run_program("evaluate", out, out, "--check-oracle").stdout.splitlines()
        self.assertIn("block Spearman", table[0])
        figures = [line.split()[-10:] for line in table[1:]]
        self.assertEqual(figures, 3 * [self.figures(report["oracle"])], "two runs and their mean")
        self.error_of("evaluate", out, out, code=2, names=["--check-oracle"])
        self.error_of("evaluate", out, self.scene, "--check-oracle", code=3, names=[self.scene])

        head, line = self.run_program("evaluate", out, "--check-uncertainty").stdout.splitlines()
        uncertainty = json.loads((out / "metrics.json").read_text())["uncertainty"]
        self.assertIn("AUSE MAE", head)
        self.assertEqual(line.split()[-1], f"{uncertainty['models']['published_ause']['images']['dssim']:.3f}")
        self.assertEqual(len(self.run_program("evaluate", out, out, "--check-uncertainty").stdout.splitlines()), 4)
        bound = uncertainty["bound"]
        self.assertEqual(bound["photos"], len(json.loads((out / "split.json").read_text())["train"]))
        for known in (row for row in bound["classes"] if row["below"] is not None and row["pixels"] > 0):
            self.assertGreater(known["covered"], 0.6)  # of photos like those that it is from
        self.error_of("evaluate", out, "--check-oracle", "--check-uncertainty", code=2, names=["--check-uncertainty"])

    @staticmethod
    def figures(quality):
        blocks = quality["blocks"]
        names = ["auroc_large_error", "auroc_above_median", "spearman", "ause_ratio", "calibration_error"]
        published = quality["published_ause"]["images"]
        values = [blocks["spearman"], blocks["auroc_large_error"], *(quality[name] for name in names),
                  *(published[name] for name in ("mae", "rmse", "dssim"))]  # fmt: skip
        return ["-" if value is None else f"{value:.3f}" for value in values]

    def test_a_folder_with_a_test_view_is_used_without_it(self):
        out = self.dir / "with_folder"
        self.run_program("sfm", self.scene, "-o", out, *RUN)
        names = self.names(out)
        every = [f"{i:03}.png" for i in range(20)]
        split = {name.rsplit("/", 1)[-1] for part in names.values() for name in part}
        spare = next(name for name in every if name not in split)
        test = names["test"][0].rsplit("/", 1)[-1]
        folder = self.dir / "others" / "synthetic_2"
        folder.mkdir(parents=True)
        for name in (spare, test):
            (folder / name).write_bytes(png(80, 60, (90, 90, 90)))
        arguments = [self.scene, "-o", out, *RUN, "--proposers", "none", "--proposal-folder", folder.parent]
        done = self.run_program("validate", *arguments)
        self.assertIn("test view", done.stderr)
        self.assertEqual(len(list((out / "confidence").glob("*.png"))), 1)

    def test_a_folder_of_which_nothing_can_be_used_is_done_without(self):
        out, folder = self.dir / "without_folder", self.dir / "squares"
        folder.mkdir()
        frames = json.loads((self.scene / "transforms.json").read_text())
        for frame in frames["frames"]:
            frame["file_path"] = frame["file_path"].rsplit("/", 1)[-1]
            (folder / frame["file_path"]).write_bytes(png(40, 40, (90, 90, 90)))
        (folder / "transforms.json").write_text(json.dumps(frames))
        arguments = [self.scene, "-o", out, *RUN, "--proposers", "warp", "--proposal-folder", folder]
        done = self.run_program("validate", *arguments)
        self.assertIn("none of its proposals can be used; going on without them", done.stderr)
        self.assertIn("generate them in the camera's shape", done.stderr)
        self.assertEqual(len(list((out / "confidence").glob("*.png"))), 5)

    def test_bad_folders_and_options(self):
        out = ["-o", self.dir / "bad"]
        missing = self.dir / "missing"
        self.error_of("validate", self.scene, *out, *RUN, "--proposal-folder", missing, code=3, names=[missing])
        self.error_of("propose", self.scene, *out, "--trajectory", "nowhere", code=2, names=["--trajectory"])
        self.run_program("sfm", self.scene, *out, *RUN)
        self.error_of("evaluate", self.dir / "bad", "--check-oracle", code=3, names=["--trajectory dataset"])


if __name__ == "__main__":
    main()

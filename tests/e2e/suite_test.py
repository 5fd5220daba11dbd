#!/usr/bin/env python3
"""What of bench/suite.py needs no training: which benchmarks are run, the table, the lead, and whether a change pays."""

import contextlib
import io
import json
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

BENCH = Path(__file__).resolve().parents[2] / "bench"
sys.path.insert(0, str(BENCH))
import suite  # noqa: E402

PROGRAM = f"""#!{sys.executable}
import json, pathlib, sys
words = sys.argv[1:]
given = dict(zip(words, words[1:]))
out, runs = pathlib.Path(given["-o"]), []
if "--fail" in words:
    sys.exit("oraclegs: error: no")
if words[0] == "ablate":
    out.mkdir(parents=True)
    psnr = {{"none": None, "uniform": {{"mean": 20}}, "oracle": {{"mean": 22.5}}, "ideal": {{"mean": 23}}}}
    (out / "tampering.json").write_text(json.dumps({{"shares": [{{"percent": 30, "psnr": psnr, "auroc": 0.9512}}]}}))
    (out / "words").write_text(" ".join(words))
    sys.exit()
for method in given["--methods"].split(","):
    for seed in range(int(given["--seeds"])):
        folder = out / "runs" / f"{{method}}-{{seed}}"
        folder.mkdir(parents=True, exist_ok=True)
        psnr = None if method == "blind" else {{"ours": 30, "3dgs": 29, "fsgs": 28}}[method] + seed
        (folder / "metrics.json").write_text(json.dumps(
            {{"test": {{"psnr": psnr, "ssim": 0.5, "psnr_color_corrected": 31}}}}))
        runs.append({{"method": method, "seed": seed, "workspace": f"runs/{{method}}-{{seed}}"}})
    runs.append({{"method": method, "seed": 9, "workspace": f"runs/{{method}}-9", "failure": "no memory"}})
(out / "bench.json").write_text(json.dumps({{"runs": runs}}))
(out / "words").write_text(" ".join(words))
"""


def runs(*psnr):
    return [{"psnr": value, "ssim": 0.9, "psnr_color_corrected": value + 1} for value in psnr]


class Suite(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.program = self.folder / "program"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)
        for scene in ("fox", "fern"):
            (self.folder / scene).mkdir()

    def run_suite(self, *words):
        out, err = io.StringIO(), io.StringIO()
        argv = ["suite.py", self.folder, self.folder / "out", "--program", self.program, *words]
        with mock.patch.object(sys, "argv", [str(word) for word in argv]):
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                suite.main()
        return out.getvalue(), err.getvalue()

    def test_scenes_that_are_there_are_run_by_their_protocol(self):
        out, err = self.run_suite("--methods", "ours,3dgs,blind", "--seeds", "2", "--options", "--iterations 100")
        self.assertIn("lego: is not there, lego-8 is left out", err)
        words = (self.folder / "out/fern-6/words").read_text()
        self.assertIn(f"--suite {self.folder}/fern ", words)
        self.assertTrue(words.endswith("--methods ours,3dgs,blind --seeds 2 --views 6 --iterations 100"), words)
        lines = out.splitlines()
        self.assertEqual(lines[0], "| scene | ours | 3dgs | blind |")
        row = "| 30.50 ± 0.71 / 0.5000 (31.00) | 29.50 ± 0.71 / 0.5000 (31.00) |  |"
        self.assertEqual(lines[2], "| fern-3 " + row)
        self.assertEqual(lines[5], "| fox-12 " + row)
        self.assertNotIn("mean", out, "one method has no scores")

    def test_lead_is_over_the_best_of_the_others(self):
        out, _ = self.run_suite("--methods", "ours,fsgs,3dgs", "--seeds", "1", "--scenes", "fox-12,fern-3")
        self.assertIn("| mean of 2 | 30.00 ± 0.00 / 0.5000 (31.00) |", out)
        self.assertIn("ours beside 3dgs: +1.00 dB, +0.0000 SSIM (fox-12 +1.00, fern-3 +1.00)", out)

    def test_a_change_is_compared_with_the_folder_before_it(self):
        self.run_suite("--methods", "ours", "--scenes", "fox-12")
        (self.folder / "out").rename(self.folder / "before")
        before = self.folder / "before/fox-12/runs"
        for file in before.glob("*/metrics.json"):
            test = json.loads(file.read_text())["test"]
            file.write_text(json.dumps({"test": {**test, "psnr": test["psnr"] - 0.25}}))
        out, _ = self.run_suite("--methods", "ours", "--scenes", "fox-12", "--before", self.folder / "before")
        self.assertIn("ours: +0.25 dB in the mean (fox-12 +0.25); it pays", out)

    def test_tampering_is_measured_on_each_scene(self):
        out, _ = self.run_suite("--tampering", "--scenes", "fox-12", "--seeds", "1", "--options=--shares 30")
        words = (self.folder / "out/fox-12/words").read_text()
        self.assertEqual(words, f"ablate {self.folder}/fox -o {self.folder}/out/fox-12 --compare tampering "
                                "--seeds 1 --views 12 --downscale 4 --shares 30")  # fmt: skip
        self.assertEqual(out.splitlines()[2], "| fox-12 | 30 % |  | 20.00 | 22.50 | 23.00 | 0.951 |")

    def test_a_failed_benchmark_ends_the_suite(self):
        with self.assertRaisesRegex(SystemExit, "fox-12: the benchmark failed"):
            self.run_suite("--scenes", "fox-12", "--options=--fail")

    def test_unknown_scenes_are_named(self):
        with self.assertRaises(SystemExit):
            self.run_suite("--scenes", "fox-13")


class Verdict(unittest.TestCase):
    def test_no_scene_may_lose_more_than_seeds_differ(self):
        before = {"fox-12": {"ours": runs(27, 27.2)}, "room-12": {"ours": runs(29, 30)}}
        after = {"fox-12": {"ours": runs(28, 28.2)}, "room-12": {"ours": runs(28.5, 29.5)}}
        self.assertTrue(suite.verdict(before, after, "ours").endswith("(fox-12 +1.00, room-12 -0.50); it pays"))
        after["room-12"]["ours"] = runs(28.2, 28.3)
        self.assertIn("does not pay: room-12 lost more than seeds differ", suite.verdict(before, after, "ours"))

    def test_a_lower_mean_does_not_pay(self):
        text = suite.verdict({"fox-12": {"ours": runs(27, 28)}}, {"fox-12": {"ours": runs(26.9, 27.9)}}, "ours")
        self.assertEqual(text, "ours: -0.10 dB in the mean (fox-12 -0.10); it does not pay")

    def test_one_seed_is_no_proof(self):
        text = suite.verdict({"fox-12": {"ours": runs(27, 28)}}, {"fox-12": {"ours": runs(29)}}, "ours")
        self.assertTrue(text.endswith("it pays; of one seed it is unknown how seeds differ"), text)

    def test_without_a_common_scene_nothing_is_said(self):
        self.assertIn("nothing to compare", suite.verdict({}, {"fox-12": {"ours": runs(27)}}, "ours"))


if __name__ == "__main__":
    unittest.main()

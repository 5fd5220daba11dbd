#!/usr/bin/env python3
"""What of bench/kinds.py needs no training: which scenes and runs are made, what is read of truth_bench, and the table."""

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
import kinds  # noqa: E402

TRUTH = """stereo images/001.png   confident  40.0 %  median error  0.100 %  over 2 %  6.00 %  over 10 %  3.00 %
stereo all              confident  59.0 %  median error  0.142 %  over 2 %  7.85 %  over 10 %  3.22 %
splat  images/000.png   median error  9.000 %  over 2 % 99.00 %  over 10 % 98.00 %  haze before 97.00 %  behind 96.00 %
splat  all              median error  1.250 %  over 2 % 12.50 %  over 10 %  4.25 %  haze before 60.87 %  behind  2.90 %
"""
PROGRAM = f"""#!{sys.executable}
import json, pathlib, sys
words = sys.argv[1:]
given = dict(zip(words, words[1:]))
with open(pathlib.Path(sys.argv[0]).with_name("words"), "a") as file:
    print(*words, file=file)
if words[0] == "demo-scene":
    pathlib.Path(words[1]).mkdir(parents=True)
    pathlib.Path(words[1], "transforms.json").write_text("{{}}")
    sys.exit()
out = pathlib.Path(given["-o"])
if out.name in given.get("--fail", ""):
    sys.exit("oraclegs: error: no")
out.mkdir(parents=True, exist_ok=True)
(out / "metrics.json").write_text(json.dumps({{"test": {{"psnr": 28, "ssim": 0.9}}}}))
"""


class Kinds(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for name, text in {"program": PROGRAM, "truth": f"#!{sys.executable}\nprint('''{TRUTH}''')\n"}.items():
            (self.folder / name).write_text(text)
            (self.folder / name).chmod(0o755)

    def run_kinds(self, *words):
        out = io.StringIO()
        argv = ["kinds.py", self.folder / "out", "--program", self.folder / "program", "--truth-bench", self.folder / "truth", *words]
        with mock.patch.object(sys, "argv", [str(word) for word in argv]), contextlib.redirect_stdout(out):
            # A file, since programs write to it, too.
            with open(self.folder / "err", "w") as file, mock.patch.object(sys, "stderr", file):
                kinds.main()
        return out.getvalue()

    def words(self):
        return (self.folder / "words").read_text().splitlines()

    def test_scenes_and_runs_of_all_kinds_are_made_once(self):
        out = self.run_kinds("--options", "--seed 3", "--scene", "--width 80")
        for kind in ("room", "object", "walls", "forward", "thin", "outdoor"):
            scene = self.folder / "out/scenes" / kind
            self.assertIn(f"demo-scene {scene} --quiet --kind {kind} --width 80", self.words())
            words = f"reconstruct {scene} -o {self.folder}/out/runs/{kind} --quiet --eval --views 8 --seed 3"
            self.assertIn(words, self.words())
        self.assertEqual(len(self.words()), 12)
        self.assertEqual(len(out.splitlines()), 8)
        self.run_kinds("--options", "--seed 3")
        self.assertEqual(len(self.words()), 18, "scenes stay; the program itself goes on with runs")

    def test_a_row_has_stereo_and_the_splat(self):
        out = self.run_kinds("--kinds", "thin")
        self.assertEqual(out.splitlines()[-1], "| thin | 0.142 % / 59.0 % | 28.00 | 0.9000 | 12.50 % / 4.25 % | 60.87 % / 2.90 % |")
        self.assertEqual({line.count("|") for line in out.splitlines()}, {7})

    def test_differences_stand_in_brackets(self):
        self.run_kinds("--kinds", "thin")
        (self.folder / "out").rename(self.folder / "before")
        metrics = self.folder / "before/runs/thin/metrics.json"
        metrics.write_text(json.dumps({"test": {"psnr": 27.5, "ssim": 0.91}}))
        out = self.run_kinds("--kinds", "thin,room", "--before", self.folder / "before")
        self.assertIn("| 28.00 (+0.50) | 0.9000 (-0.0100) | 12.50 % (+0.00) / 4.25 % (+0.00) |", out)
        self.assertIn("| room | 0.142 % / 59.0 % | 28.00 |", out, "which was not there before")

    def test_the_others_are_shown_where_one_fails(self):
        with self.assertRaisesRegex(SystemExit, "object failed"):
            self.run_kinds("--kinds", "object,room", "--options=--fail object")
        self.assertEqual(self.words()[-1].split()[0], "reconstruct")

    def test_unknown_kinds_are_named(self):
        with self.assertRaises(SystemExit):
            self.run_kinds("--kinds", "room,cave")


class Truth(unittest.TestCase):
    def test_only_the_lines_of_all_views_are_read(self):
        self.assertEqual(
            kinds.truth_of(TRUTH),
            {"confident": 59, "stereo_error": 0.142, "over_2": 12.5, "over_10": 4.25, "before": 60.87, "behind": 2.9},
        )
        self.assertEqual(kinds.truth_of(TRUTH.split("splat")[0]), {"confident": 59, "stereo_error": 0.142})
        self.assertEqual(kinds.truth_of(""), {})

    def test_what_is_missing_leaves_its_cell_empty(self):
        self.assertIn("| walls |  | 28.00 |  |  |  |", kinds.table({"walls": {"psnr": 28.0, "ssim": None}}, {}))


if __name__ == "__main__":
    unittest.main()

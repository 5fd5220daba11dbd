#!/usr/bin/env python3
"""What of bench/growth.py needs no measuring: exponents, settings, table, plot, and which runs are made, of a stand-in."""

import contextlib
import io
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path
from unittest import mock

BENCH = Path(__file__).resolve().parents[2] / "bench"
sys.path.insert(0, str(BENCH))
import growth  # noqa: E402
import log_plot  # noqa: E402

PROGRAM = f"""#!{sys.executable}
import json, pathlib, subprocess, sys
words = sys.argv[1:]
if words[0] == "info":
    print(json.dumps({{"views": 7, "sizes": {{"300x400": 7}}}}))
    sys.exit()
given = dict(zip(words, words[1:]))
if given["--views"] == "5":
    sys.exit(4)
subprocess.run(["sleep", "0.2"])
out, photos = pathlib.Path(given["-o"]), int(given["--views"])
out.mkdir()
(out / "stages.json").write_text(json.dumps({{"sfm": {{"seconds": photos**2}}, "train": {{"seconds": 2 * photos}}}}))
(out / "metrics.json").write_text(json.dumps({{"peak_memory_bytes": 5e9, "gaussians": 70}}))
(out / "split.json").write_text(json.dumps({{"train": ["a"] * photos}}))
"""


def rows(scene="fox"):
    return [
        {"scene": scene, "at": n, "sfm": 0.1 * n**2, "depth": 0.2 * n, "train": 0.01 * n, "rest": 0.0, "whole": 1.0 + n,
         "memory": 0.1 * n**1.5, "proposals": 96}
        for n in (3, 10, 50)
    ]  # fmt: skip


class Exponents(unittest.TestCase):
    def test_they_are_those_of_powers(self):
        self.assertAlmostEqual(growth.exponent([1, 2, 4, 9], [3 * x**1.4 for x in (1, 2, 4, 9)]), 1.4)
        self.assertAlmostEqual(growth.exponent([1, 2], [8, 4]), -1)

    def test_one_place_and_no_time_have_none(self):
        self.assertIsNone(growth.exponent([3, 3], [1, 2]))
        self.assertIsNone(growth.exponent([1, 2], [0, 2]))
        self.assertIsNone(growth.exponent([], []))

    def test_short_stages_have_none(self):
        found = growth.exponents(rows())
        self.assertEqual(list(found), ["sfm", "depth", "whole", "memory"])
        self.assertAlmostEqual(found["sfm"], 2)


class Table(unittest.TestCase):
    def test_it_has_a_row_a_setting_and_names_what_is_steep(self):
        text = growth.table("photos", [*rows(), *rows("room")[:1]])
        lines = text.splitlines()
        self.assertEqual(lines[0], "| scene | photos | proposals | sfm | depth | train | whole | memory, GB |")
        self.assertEqual(lines[4], "| fox | 50 | 96 | 250 | 10 | 0.5 | 51 | 35.36 |")
        self.assertEqual({line.count("|") for line in lines[:6]}, {9})
        self.assertIn("Exponents, fox: sfm 2.00, depth 1.00, whole 0.91, memory 1.50", lines)
        self.assertIn("Exponents, room: none", lines)
        self.assertIn("- fox, sfm: photos^2.00: " + growth.CAUSES["photos", "sfm"], lines)
        self.assertIn("- fox, memory: photos^1.50: cause unknown", lines)
        self.assertNotIn("- fox, depth", text)
        self.assertNotIn("whole:", text)
        self.assertIn("- fox, sfm: Gaussians^2.00: cause unknown", growth.table("gaussians", rows()))

    def test_settings_are_what_the_scene_has(self):
        scene = {"views": 12, "sizes": {"300x400": 11, "3000x4000": 1}}
        self.assertEqual(growth.settings("photos", [3, 12, 24], scene), {3: 3, 12: 12})
        self.assertEqual(growth.settings("pixels", [200, 500, 1000], scene), {200 * 150: 200, 400 * 300: 400})
        self.assertEqual(growth.settings("cores", [1, 100000], scene), {1: 1})


class Plot(unittest.TestCase):
    def drawn(self, rows_of_axis):
        with tempfile.TemporaryDirectory() as folder:
            growth.draw(rows_of_axis, Path(folder) / "plot.svg")
            return xml.etree.ElementTree.parse(Path(folder) / "plot.svg").getroot()

    def test_it_has_a_panel_an_axis_and_a_line_a_stage(self):
        root = self.drawn({"photos": rows("a < b"), "cores": rows()})
        space = "{http://www.w3.org/2000/svg}"
        self.assertEqual(len(root.findall(f"{space}g")), 2)
        self.assertEqual(len(root.findall(f".//{space}polyline")), 2 * 3)
        texts = [text.text for text in root.iter(f"{space}text")]
        self.assertIn("a < b: seconds", texts)
        self.assertIn("sfm 2.00", texts)
        for line in root.iter(f"{space}polyline"):
            for x, y in (map(float, point.split(",")) for point in line.get("points").split()):
                self.assertTrue(0 <= x <= log_plot.WIDTH / log_plot.ACROSS and 0 <= y <= log_plot.PANEL_HEIGHT)

    def test_labels_do_not_overlap_nor_leave_the_panel(self):
        lines = [log_plot.Line(str(n), "#000", [(1, 1), (2, 1 + n / 1000)]) for n in range(12)]
        texts = [part for part in log_plot.draw_panel(log_plot.Panel("t", "x", lines)) if 'fill="#000">' in part]
        heights = [float(part.split('y="')[1].split('"')[0]) for part in texts]
        self.assertEqual(len(heights), 12)
        self.assertGreaterEqual(min(b - a for a, b in zip(heights, heights[1:])), log_plot.LABEL_HEIGHT - 0.11)
        self.assertLessEqual(max(heights), log_plot.TOP + log_plot.PLOT_HEIGHT)

    def test_nothing_is_drawn_of_nothing(self):
        self.drawn({"photos": []})
        self.drawn({"photos": rows()[:1]})

    def test_ticks_hold_the_range(self):
        self.assertEqual(log_plot.ticks(3, 40), [2, 5, 10, 20, 50])
        self.assertEqual(log_plot.ticks(5, 5), [5, 10])
        self.assertEqual(log_plot.ticks(0.03, 4000), [0.01, 0.1, 1, 10, 100, 1000, 10000])


class Runs(unittest.TestCase):
    def test_finished_runs_are_kept_and_failed_ones_left_out(self):
        with tempfile.TemporaryDirectory() as root:
            root = Path(root)
            (root / "fox").mkdir()
            program = root / "oraclegs"
            program.write_text(PROGRAM)
            program.chmod(0o755)
            words = ["growth.py", root, root / "out", "--scenes", "fox,absent", "--axis", "photos", "--photos", "2,4,5,8",
                     "--program", program, "--plot", root / "plot.svg"]  # fmt: skip

            def call(*more):
                out, err = io.StringIO(), io.StringIO()
                with mock.patch("sys.argv", [str(word) for word in (*words, *more)]):
                    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                        growth.main()
                made = [line for line in err.getvalue().splitlines() if line.startswith("+")]
                return out.getvalue(), err.getvalue(), made

            text, errors, made = call()
            self.assertEqual(len(made), 3)  # of 2, 4 and 5 photos
            self.assertIn("fox-photos-5.log: failed with exit code 4", errors)
            self.assertIn("absent is not there", errors)
            self.assertRegex(text, r"\| fox \| 4 \| 0 \| 16 \| 8\.0 \| .* \| 5\.00 \| 0\.00 \|")
            self.assertIn("sfm 2.00, train 1.00", text)
            again, _, made = call()
            self.assertEqual((again, len(made)), (text, 1))
            _, _, made = call("--options=--max-size=9 --views 3")
            self.assertEqual(len(made), 3)
            self.assertIn("--views 2 ", made[0])
            self.assertNotIn("--views 3", made[0])
            self.assertNotIn("--max-size 500", made[0])


if __name__ == "__main__":
    unittest.main()

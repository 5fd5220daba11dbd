"""docs/scaling.md quotes what bench/simulate_suite.py prints."""

import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "bench/simulate_suite.py"
sys.path.insert(0, str(SCRIPT.parent))

import simulate_suite as suite  # noqa: E402


class Scaling(unittest.TestCase):
    def test_the_page_has_the_numbers_of_the_script(self):
        printed = subprocess.run([sys.executable, SCRIPT], capture_output=True, text=True, check=True).stdout
        page = (ROOT / "docs/scaling.md").read_text()
        for paragraph in printed.strip().split("\n\n"):
            self.assertIn(paragraph, page)

    def test_one_gpu_does_all_of_the_work_one_after_the_other(self):
        night = suite.Night(scenes=5, gpus=1, failures=0.0, stragglers=0.0, spread=0.0, minutes=10.0)
        took, work, moving, starts, gave_up = suite.simulate(night)
        volume = sum(suite.Scene().volumes().values()) / night.link
        self.assertAlmostEqual(took, 5 * (600 + 10 + volume), places=6)
        self.assertAlmostEqual(work, 3000)
        self.assertAlmostEqual(moving, 5 * volume, places=6)
        self.assertEqual((starts, gave_up), (5, 0))

    def test_gpus_share_the_file_system(self):
        night = suite.Night(scenes=4, gpus=4, failures=0.0, stragglers=0.0, spread=0.0, minutes=1.0, disk=1e9, link=1e9)
        took = suite.simulate(night)[0]
        self.assertAlmostEqual(took, 60 + 10 + 4 * sum(suite.Scene().volumes().values()) / 1e9, places=6)

    def test_what_always_breaks_down_is_given_up(self):
        night = suite.Night(scenes=3, gpus=2, failures=1.0, retries=2)
        _, _, _, starts, gave_up = suite.simulate(night)
        self.assertEqual((starts, gave_up), (9, 3))


if __name__ == "__main__":
    unittest.main()

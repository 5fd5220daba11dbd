"""Stages that several processes make: same results, failures, what is refused."""

import json
import os
import shutil
import unittest

from harness import ManyViews, main

RUN = ["--views", 10, "--test-every", 4, "--stereo-iterations", 3, "--stereo-passes", 1, "--iterations", 20,
       "--max-gaussians", 1500, "--proxy-models", 3, "--trajectory", "interpolate", "--proposals", 10]  # fmt: skip


def contents(folder):
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


class Spread(ManyViews):
    def begun(self, name):
        """A workspace with depth, the same for all: COLMAP's points differ between two runs."""
        first, out = self.dir / "first", self.dir / name
        if not first.exists():
            self.run_program("depth", self.scene, "-o", first, *RUN)
        shutil.copytree(first, out)
        return out

    def test_results_are_those_of_one_process(self):
        alone, divided = self.begun("alone"), self.begun("divided")
        self.run_program("train", self.scene, "-o", alone, *RUN)
        said = self.run_program("train", self.scene, "-o", divided, *RUN, "--spread", 2).stderr
        for name in ("proxies 2/2", "propose 1/2", "validate 2/2"):
            self.assertIn(name, said)
        self.assertNotIn("this process does its work", said)
        for folder in ("proposals", "confidence"):
            self.assertEqual(contents(divided / folder), contents(alone / folder), folder)
        self.assertEqual((divided / "point_cloud.ply").read_bytes(), (alone / "point_cloud.ply").read_bytes())
        self.assertEqual([p.name for p in (divided / "parts").iterdir()], ["logs"])
        before = (divided / "stages.json").read_bytes()
        self.run_program("train", self.scene, "-o", divided, *RUN)
        self.assertEqual((divided / "stages.json").read_bytes(), before, "--spread is no option of the result")

    def test_a_slurm_that_is_missing_is_one_line(self):
        out = self.begun("no_slurm")
        nowhere = {**os.environ, "PATH": "/nonexistent"}
        self.error_of("train", self.scene, "-o", out, *RUN, "--spread", 2, "--launcher", "slurm",
                      code=4, names=["Slurm"], env=nowhere)  # fmt: skip

    @unittest.skipUnless("ORACLEGS_TEST_SLURM" in os.environ, "needs a Slurm: tests/slurm/run.sh starts one")
    def test_slurm_gives_the_same_results(self):
        alone, divided = self.begun("not_slurm"), self.begun("slurm")
        self.run_program("train", self.scene, "-o", alone, *RUN)
        slurm = ["--spread", 3, "--launcher", "slurm", "--slurm-cpus", 1, "--slurm-poll", 0.5]
        said = self.run_program("train", self.scene, "-o", divided, *RUN, *slurm).stderr
        self.assertEqual(said.count("jobs to Slurm as array"), 3, said)
        self.assertNotIn("this process does its work", said)
        self.assertEqual(contents(divided / "confidence"), contents(alone / "confidence"))
        self.assertEqual((divided / "point_cloud.ply").read_bytes(), (alone / "point_cloud.ply").read_bytes())

    def test_bad_requests(self):
        out = self.begun("refused")
        self.error_of("train", self.scene, "-o", out, *RUN, "--launcher", "slurm", code=2, names=["--spread"])
        self.error_of("share", self.dir / "nothing", "--stage", "proxies", code=3, names=["holds no run"])
        self.error_of("share", out, "--stage", "proxies", "--part", "3/2", code=2, names=["--part 3/2"])
        self.error_of("share", out, "--stage", "train", code=2, names=["train: is no stage"])
        self.error_of("share", out, "--stage", "proxies", "--key", "other", code=4, names=[out])
        self.assertFalse((out / "parts").exists())
        self.assertNotIn("proxies", json.loads((out / "stages.json").read_text()))


if __name__ == "__main__":
    main()

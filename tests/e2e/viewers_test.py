#!/usr/bin/env python3
"""Exports drawn by Spark and by three.js in headless Chromium (tests/foreign/viewers.mjs), beside the program's own renders."""

import json
import math
import subprocess

from harness import ROOT, SMALL_RUN, EndToEnd, main

FOREIGN = ROOT / "tests/foreign"
FILES = ["run.ply", "run.compressed.ply", "run.spz", "four.spz", "run.sog", "run.glb", "run.splat"]
NOT_READ = {"spark four.spz", "spark run.glb"}  # by these versions


class Viewers(EndToEnd):
    def test_other_viewers_show_what_the_program_renders(self):
        packages = FOREIGN / "node_modules"
        self.assertTrue(packages.is_dir(), f"the viewers are not installed: run scripts/test.sh once, or npm ci --prefix {FOREIGN}")
        out, drawn = self.dir / "run", self.dir / "drawn"
        self.run_program("reconstruct", self.scene, "-o", out, *SMALL_RUN)
        for name in FILES:
            self.run_program("export", out, "-o", self.dir / name, *(["--spz-version", 4] if name == "four.spz" else []))
        self.run_program("render", out, "--path", "test", "-o", drawn, "--no-video")

        scene = json.loads((self.scene / "transforms.json").read_text())
        matrices = {frame["file_path"]: frame["transform_matrix"] for frame in scene["frames"]}
        tests = json.loads((out / "split.json").read_text())["test"]
        poses = [{"matrix": matrices[name], "image": str(drawn / name.replace("/", "_"))} for name in tests]
        size = {"width": scene["w"], "height": scene["h"], "fov": 2 * math.degrees(math.atan(scene["h"] / 2 / scene["fl_y"]))}
        self.assertGreater(len(poses), 1)

        job = self.dir / "job.json"
        files = [str(self.dir / name) for name in FILES]
        job.write_text(json.dumps({**size, "not_read": sorted(NOT_READ), "files": files, "poses": poses}))
        done = subprocess.run(["node", FOREIGN / "viewers.mjs", job], capture_output=True, text=True, timeout=400, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        scores = json.loads(done.stdout)
        self.assertEqual(len(scores), 10)
        for name, score in scores.items():
            with self.subTest(name):
                # So few Gaussians are large, and these viewers cut large ones off; a picture that is mirrored, turned or in
                # other colors has 12 dB.
                self.assertGreater(min(score["psnr"]), 20)
                self.assertGreater(min(score["alike"]), 36)  # what the format loses


if __name__ == "__main__":
    main()

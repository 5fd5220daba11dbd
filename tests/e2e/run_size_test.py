#!/usr/bin/env python3
"""Commands on a run work at its size, also where that was automatic, or at --max-size."""

import json
import re
import subprocess

from harness import EndToEnd, command, main, read_png

WIDTH, OWN, ASKED = 640, 500, 200  # pixels: of the photos, of a draft, of --max-size


class RunSize(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene, cls.run_folder = cls.dir / "large", cls.dir / "run"
        size = ["--demo-views", 6, "--width", WIDTH, "--height", 480, "--samples", 1]
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *size), check=True)
        cls.few = few = ["--iterations", 40, "--max-gaussians", 3000, "--init", "random", "--proposers", "none", "--no-report"]
        subprocess.run(command("reconstruct", cls.scene, "-o", cls.run_folder, "--quiet", "--quality", "draft", "--eval", *few), check=True)

    def widths(self, folder):
        return {read_png(file)[0] for file in folder.rglob("*.png")}

    def test_the_run_is_smaller_than_its_photos(self):
        self.assertEqual(json.loads((self.run_folder / "options.json").read_text())["options"]["max-size"], "auto")
        self.assertEqual(self.widths(self.run_folder / "renders/test"), {OWN})

    def test_render_takes_its_size_or_another(self):
        for options, width in [([], OWN), (["--max-size", ASKED], ASKED)]:
            out = self.dir / f"frames{width}"
            self.run_program("render", self.run_folder, "-o", out, "--frames", 1, *options)
            self.assertEqual(self.widths(out), {width})

    def test_cameras_take_its_size_or_another(self):
        for options, width in [([], OWN), (["--max-size", ASKED], ASKED)]:
            out = self.dir / f"cameras{width}"
            self.run_program("cameras", self.run_folder, "-o", out, *options)
            self.assertEqual(json.loads((out / "transforms.json").read_text())["w"], width)

    def test_mesh_takes_voxels_of_its_size(self):
        voxels = {}
        for options, width in [([], OWN), (["--max-size", ASKED], ASKED)]:
            said = self.run_program("mesh", self.run_folder, "-o", self.dir / f"{width}.ply", "--renders", 6, "--min-part", 0, "--min-renders", 1, *options)
            voxels[width] = float(re.search(r"voxels of ([0-9.e-]+)", said.stdout)[1])
        self.assertGreater(voxels[ASKED], 1.5 * voxels[OWN])

    def test_a_splat_of_others_is_scored_at_its_size(self):
        out = self.dir / "scored"
        self.run_program("evaluate", self.run_folder, "--ply", self.run_folder / "point_cloud.ply", "-o", out)
        self.assertEqual(self.widths(out / "renders/test"), {OWN})

    def test_other_options_than_the_size_are_refused(self):
        self.error_of("render", self.run_folder, "--downscale", 3, code=3, names=["--downscale was auto, now is 3"])

    def test_what_stands_before_white_is_trained_on_white(self):
        scene = self.dir / "object"
        size = ["--demo-views", 6, "--width", 120, "--height", 90, "--samples", 1]
        subprocess.run(command("demo-scene", scene, "--quiet", "--kind", "object", *size), check=True)
        run = self.dir / "on_white"
        said = self.run_program("reconstruct", scene, "-o", run, "--eval", *self.few)
        self.assertIn("a white background (--background)", said.stderr)
        self.assertEqual(json.loads((run / "options.json").read_text())["size"]["background"], "white")
        self.run_program("render", run, "-o", self.dir / "white", "--path", "test", "--no-video")
        for file in (self.dir / "white").glob("*.png"):
            self.assertEqual(set(read_png(file)[3][:3]), {255}, "the corner")
        scored = self.dir / "scored_on_white"
        self.run_program("evaluate", scene, "--ply", run / "point_cloud.ply", "-o", scored, "--eval")
        own = json.loads((run / "metrics.json").read_text())["test"]["psnr"]
        self.assertAlmostEqual(json.loads((scored / "metrics.json").read_text())["test"]["psnr"], own, places=2)


if __name__ == "__main__":
    main()

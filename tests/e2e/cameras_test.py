#!/usr/bin/env python3
"""`oraclegs cameras`: what it writes is a scene that trains."""

import json

from harness import SMALL_RUN, EndToEnd, files_below, main


class Cameras(EndToEnd):
    def test_of_a_run_are_a_scene_to_train_on(self):
        out, dataset = self.dir / "out", self.dir / "dataset"
        self.run_program("train", self.scene, "-o", out, *SMALL_RUN, "--iterations", 5, "--downscale", 2)
        before = files_below(self.scene)
        text = self.run_program("cameras", out, "-o", dataset).stdout
        self.assertIn("8 images", text)
        self.assertEqual(files_below(self.scene), before)
        transforms = json.loads((dataset / "transforms.json").read_text())
        self.assertEqual((transforms["w"], transforms["h"]), (48, 36))
        for frame in transforms["frames"]:
            self.assertTrue((dataset / frame["file_path"]).is_file())
        split = f"@{dataset}/split.json"
        again = self.dir / "again"
        self.run_program("reconstruct", dataset, "-o", again, *SMALL_RUN, "--iterations", 5, "--train-views", split, "--test-views", split)
        self.assertEqual(json.loads((again / "split.json").read_text()), json.loads((dataset / "split.json").read_text()))

    def test_of_a_scene_have_the_asked_size(self):
        dataset = self.dir / "half"
        self.run_program("cameras", self.scene, "-o", dataset, "--downscale", 3)
        self.assertEqual(json.loads((dataset / "transforms.json").read_text())["w"], 32)

    def test_mistakes(self):
        out = self.dir / "mistakes"
        self.run_program("sfm", self.scene, "-o", out, *SMALL_RUN)
        self.error_of("cameras", out, code=2, names=["-o"])
        self.error_of("cameras", out, "-o", out, code=3, names=["not an empty folder"])
        self.error_of("cameras", out, "-o", self.dir / "x", "--downscale", 2, code=2, names=["--downscale"])
        self.error_of("cameras", self.scene, "-o", self.scene / "x", code=3, names=["never written to"])
        self.error_of("cameras", self.scene / "images", "-o", self.dir / "x", code=3, names=["no poses"])


if __name__ == "__main__":
    main()

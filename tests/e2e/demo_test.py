#!/usr/bin/env python3
"""`oraclegs demo`: a scene, its reconstruction and an image to look at."""

import unittest

from harness import DEMO, EndToEnd, main, read_png


class Demo(EndToEnd):
    def test_ends_with_an_image(self):
        out = self.dir / "a demo"
        arguments = ["demo", "-o", out, "--iterations", 10, "--views", 3, *DEMO]
        lines = self.run_program(*arguments).stdout.splitlines()
        self.assertEqual(lines[-1], str(out / "demo.png"))
        width, height, channels, _ = read_png(out / "demo.png")
        self.assertEqual((width, height, channels), (2 * 96 + 4, 72, 3))
        self.assertTrue((out / "run/point_cloud.ply").exists())
        before = (out / "run/point_cloud.ply").stat().st_mtime_ns
        self.assertEqual(self.run_program(*arguments).stdout.splitlines()[-1], str(out / "demo.png"))
        self.assertEqual((out / "run/point_cloud.ply").stat().st_mtime_ns, before, "a finished demo is kept")

    def test_bad_input(self):
        self.error_of("demo", "--views", 2, code=2, names=["--views"])
        photos = self.dir / "photos"
        (photos / "scene").mkdir(parents=True)
        (photos / "scene/mine.txt").write_text("mine")
        self.error_of("demo", "-o", photos, code=4, names=["scene"])
        self.assertEqual((photos / "scene/mine.txt").read_text(), "mine")


if __name__ == "__main__":
    main()

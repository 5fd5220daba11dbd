"""Figures from the outside: the files, and what is refused in one line."""

import unittest

from harness import ManyViews, main, read_png

RUN = ["--views", 10, "--test-every", 4, "--set", "stereo-iterations=3", "--set", "stereo-passes=1", "--iterations", 20,
       "--max-gaussians", 1500, "--proposers", "warp", "--proposals", 4, "--trajectory", "dataset"]  # fmt: skip


class Figure(ManyViews):
    def test_confidence_and_comparison(self):
        runs = [self.dir / "first", self.dir / "second"]
        for seed, run in enumerate(runs):
            self.run_program("reconstruct", self.scene, "-o", run, *RUN, "--seed", seed)
        done = self.run_program("figure", runs[0], "-o", self.dir / "confidence.png", "--rows", 2, "--panel-width", 100)
        self.assertIn("confidence.png", done.stdout)
        self.assertEqual(read_png(self.dir / "confidence.png")[0], 8 + 3 * 100 + 2 * 6 + 8)
        self.assertTrue((self.dir / "confidence.pdf").read_bytes().startswith(b"%PDF"))
        self.run_program("figure", *runs, "-o", self.dir / "crops", "--crop", "10,10,40,30", "--labels", "one,two")
        width, height = read_png(self.dir / "crops.png")[:2]
        self.assertGreater(width, 3 * 240)
        self.assertGreater(height, 4 * 180)

        refused = self.dir / "refused"
        self.error_of("figure", runs[0], code=2, names=["-o"])
        self.error_of("figure", self.scene, "-o", refused, code=2, names=["workspace"])
        self.error_of("figure", *runs, "-o", refused, "--crop", "1,2", code=2, names=["--crop"])
        self.error_of("figure", *runs, "-o", refused, "--kind", "confidence", code=2, names=["--kind confidence"])
        self.error_of("figure", runs[0], "-o", refused, "--show", "nobody", code=3, names=["--show", "nobody"])
        self.error_of("figure", *runs, self.dir / "third", "-o", refused, code=3, names=["third"])
        self.assertEqual(list(self.dir.glob("refused*")), [])


if __name__ == "__main__":
    main()

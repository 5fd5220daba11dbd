"""Every benchmark runs once, on little data."""

import subprocess
from pathlib import Path

from harness import PROGRAM, EndToEnd, command, main

PROGRAMS = Path(PROGRAM).parent
NETWORKS = [("depth_anything_bench", "small", 98, 70), ("vggt_bench", "--views", 1, "--width", 28, "--height", 28),
            ("seva_bench", 1, 64), ("seva_parts_bench", "encode", 64, 64), ("seva_parts_bench", "decode", 64, 64),
            ("seva_parts_bench", "tiled", 64, 64), ("seva_parts_bench", "clip", 64, 64)]  # fmt: skip


class Benchmarks(EndToEnd):
    def measured(self, program, *arguments):
        words = [str(word) for word in (PROGRAMS / program, *arguments)]
        done = subprocess.run(words, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_depth_truth(self):
        scene, out = self.dir / "room", self.dir / "out"
        size = ["--demo-views", 6, "--width", 80, "--height", 60, "--samples", 1]
        subprocess.run(command("demo-scene", scene, "--quiet", *size), check=True)
        self.run_program("depth", scene, "-o", out, "--views", 4, "--set", "stereo-iterations=3", "--set", "stereo-passes=1")
        self.assertRegex(self.measured("depth_truth_bench", out), r"(?m)^all +confident +[0-9.]+ %")

    def test_networks_of_full_size_on_small_images(self):
        for program, *arguments in NETWORKS:
            if (PROGRAMS / program).exists():  # built where libtorch is
                with self.subTest(program, arguments=arguments):
                    self.assertRegex(self.measured(program, *arguments), r"[0-9.]+ (s|GiB)\b")

    def test_a_benchmark_says_how_it_is_called(self):
        done = subprocess.run([PROGRAMS / "depth_truth_bench"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("usage: depth_truth_bench", done.stderr)


if __name__ == "__main__":
    main()

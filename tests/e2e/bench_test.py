"""Every benchmark runs once, on little data."""

import json
import math
import re
import struct
import subprocess
from pathlib import Path

from harness import PROGRAM, EndToEnd, command, main

PROGRAMS = Path(PROGRAM).parent
NETWORKS = [("depth_anything_bench", "small", 98, 70), ("vggt_bench", "--views", 1, "--width", 28, "--height", 28),
            ("seva_bench", 1, 64), ("seva_parts_bench", "encode", 64, 64), ("seva_parts_bench", "decode", 64, 64),
            ("seva_parts_bench", "tiled", 64, 64), ("seva_parts_bench", "clip", 64, 64)]  # fmt: skip


def halve_distances(ply, frame):
    """Halves all distances from a camera, to which the splat looks as before."""
    eye = [row[3] for row in frame["transform_matrix"][:3]]
    data = bytearray(ply.read_bytes())
    begin = data.index(b"end_header\n") + len(b"end_header\n")
    names = re.findall(rb"property float (\w+)", data[:begin])
    for row in range(begin, len(data), 4 * len(names)):
        for k, name in enumerate(names):
            (value,) = struct.unpack_from("<f", data, row + 4 * k)
            if name in (b"x", b"y", b"z"):
                value = (value + eye["xyz".index(name.decode())]) / 2
            elif name.startswith(b"scale_"):
                value += math.log(0.5)
            struct.pack_into("<f", data, row + 4 * k, value)
    ply.write_bytes(data)


class Benchmarks(EndToEnd):
    def measured(self, program, *arguments):
        words = [str(word) for word in (PROGRAMS / program, *arguments)]
        done = subprocess.run(words, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_truth_of_stereo_and_of_the_splat(self):
        scene, out = self.dir / "room", self.dir / "out"
        size = ["--demo-views", 6, "--width", 80, "--height", 60, "--samples", 1]
        subprocess.run(command("demo-scene", scene, "--quiet", *size), check=True)
        few = ["--eval", "--views", 4, "--set", "stereo-iterations=3", "--set", "stereo-passes=1"]
        self.run_program("depth", scene, "-o", out, *few)
        found = self.measured("truth_bench", out)
        self.assertRegex(found, r"(?m)^stereo all +confident +[0-9.]+ %")
        self.assertNotIn("splat", found, "none is trained yet")
        self.run_program("reconstruct", scene, "-o", out, *few, "--iterations", 50, "--max-gaussians", 1500, "--proposers", "none")
        found = self.measured("truth_bench", out)
        self.assertRegex(found, r"(?m)^splat  images/000.png +median error")
        self.assertRegex(found, r"(?m)^splat  all +median error +[0-9.]+ % .* haze before +[0-9.]+ %  behind +[0-9.]+ %$")
        halve_distances(out / "point_cloud.ply", json.loads((scene / "transforms.json").read_text())["frames"][0])
        found = self.measured("truth_bench", out)
        before, behind = re.search(r"(?m)^splat  all .* haze before +([0-9.]+) %  behind +([0-9.]+) %$", found).groups()
        self.assertGreater(float(before), 85)
        self.assertLess(float(behind), 15)
        self.assertRegex(found, r"(?m)^splat  all .* over 10 % +(9\d|100)\.")

    def test_networks_of_full_size_on_small_images(self):
        for program, *arguments in NETWORKS:
            if (PROGRAMS / program).exists():  # built where libtorch is
                with self.subTest(program, arguments=arguments):
                    self.assertRegex(self.measured(program, *arguments), r"[0-9.]+ (s|GiB)\b")

    def test_a_benchmark_says_how_it_is_called(self):
        done = subprocess.run([PROGRAMS / "truth_bench"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("usage: truth_bench", done.stderr)


if __name__ == "__main__":
    main()

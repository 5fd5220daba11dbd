#!/usr/bin/env python3
"""`oraclegs mesh` and the values that `render` shows, on a small room of known truth."""

import json
import re
import struct
import subprocess
from pathlib import Path

from harness import PROGRAM, EndToEnd, command, files_below, main, read_png

RUN = ["--views", 8, "--iterations", 600, "--max-gaussians", 6000, "--proposers", "none", "--set", "stereo-iterations=4"]


class Mesh(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene, cls.out = cls.dir / "room", cls.dir / "out"
        size = ["--demo-views", 10, "--width", 120, "--height", 90, "--samples", 2]
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *size), check=True)
        subprocess.run(command("reconstruct", cls.scene, "-o", cls.out, "--quiet", *RUN), check=True)
        cls.before = files_below(cls.scene)

    def test_a_mesh_is_near_the_truth(self):
        done = self.run_program("mesh", self.out, "--renders", 20)
        mesh = self.out / "mesh.ply"
        self.assertIn(str(mesh), done.stdout)
        self.assertTrue(mesh.read_bytes().startswith(b"ply\nformat binary_little_endian 1.0\n"))
        self.assertEqual(files_below(self.scene), self.before)
        bench = Path(PROGRAM).parent / "mesh_truth_bench"
        if bench.exists():  # a build with benchmarks
            text = subprocess.run([bench, mesh], check=True, capture_output=True, text=True).stdout
            self.assertLess(float(re.search(r"median [0-9.]+ \(([0-9.]+) %\)", text)[1]), 2, text)

    def test_glb_is_valid_from_outside(self):
        file = self.dir / "room.glb"
        self.run_program("mesh", self.out, "-o", file, "--renders", 8, "--voxel", 0.08)
        data = file.read_bytes()
        magic, version, length, text, kind = struct.unpack("<4sIII4s", data[:20])
        self.assertEqual((magic, version, length, kind), (b"glTF", 2, len(data), b"JSON"))
        document = json.loads(data[20 : 20 + text])
        self.assertEqual(set(document["meshes"][0]["primitives"][0]["attributes"]), {"POSITION", "NORMAL", "COLOR_0"})
        # The floor lies at z = 0; turned so that y is up, it is below the rest.
        self.assertLess(document["accessors"][0]["min"][2], 0.3)

    def test_errors_name_the_fix(self):
        self.error_of("mesh", self.out, "-o", self.dir / "room.obj", code=2, names=["room.obj", ".glb"])
        self.error_of("mesh", self.out, "--voxel", 1e-5, code=2, names=["--voxel", "at least"])
        self.error_of("mesh", self.out, "--voxel", 0.05, "--trunc", 9, code=2, names=["--trunc"])
        self.error_of("mesh", self.scene, code=2, names=[self.scene, "--ply"])
        self.error_of("mesh", self.scene, "--ply", self.out / "point_cloud.ply", code=2, names=["-o"])
        unfinished = self.dir / "unfinished"
        self.run_program("sfm", self.scene, "-o", unfinished, *RUN, "--init", "random")
        self.error_of("mesh", unfinished, code=3, names=[unfinished / "point_cloud.ply"])
        self.error_of("mesh", self.out, "--min-part", 1, "-o", self.dir / "none.ply", code=3, names=["no surface"])
        self.error_of("mesh", self.out, "-o", self.scene / "mesh.ply", code=3, names=[self.scene])

    def test_render_writes_each_value_and_path(self):
        frames = ["--frames", 3, "--no-video", "--quiet"]
        self.run_program("render", self.out, "--path", "spiral", "--what", "color,depth,normals,support", *frames)
        folder = self.out / "renders/spiral"
        for value in ["", "depth", "normals", "support"]:
            width, height, channels, pixels = read_png(folder / value / "0001.png")
            self.assertEqual((width, height, channels), (120, 90, 3))
            self.assertGreater(len(set(pixels)), 8, value)
        self.run_program("render", self.out, "--path", "interpolate", "--what", "depth", *frames)
        self.assertEqual(len(list((self.out / "renders/interpolate/depth").glob("*.png"))), 3)
        self.error_of("render", self.out, "--what", "depths", code=2, names=["--what", "normals"])


if __name__ == "__main__":
    main()

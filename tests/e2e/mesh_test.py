#!/usr/bin/env python3
"""`oraclegs mesh` and the values that `render` shows, on a small room of known truth."""

import json
import re
import struct
import subprocess
from collections import Counter
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
        self.assertEqual(set(document["meshes"][0]["primitives"][0]["attributes"]), {"POSITION", "NORMAL", "TEXCOORD_0"})
        self.assertEqual(document["images"][0]["mimeType"], "image/jpeg")
        # The floor lies at z = 0; turned so that y is up, it is below the rest.
        self.assertLess(document["accessors"][0]["min"][2], 0.3)

    def test_obj_has_a_texture_beside_it_and_few_triangles(self):
        file = self.dir / "obj" / "room.obj"
        done = self.run_program("mesh", self.out, "-o", file, "--renders", 8, "--voxel", 0.08, "--triangles", 2000)
        self.assertEqual(sorted(p.name for p in file.parent.iterdir()), ["room.mtl", "room.obj", "room_texture.png"])
        width, height, channels, pixels = read_png(file.parent / "room_texture.png")
        self.assertEqual((width, channels), (height, 3))
        self.assertIn(f"{width} x {width} pixels", done.stdout)
        self.assertGreater(len(set(pixels)), 64)
        kinds = Counter(line.split(" ", 1)[0] for line in file.read_text().splitlines())
        self.assertGreater(kinds["f"], 1000)
        self.assertLessEqual(kinds["f"], 2000)
        self.assertEqual(kinds["v"], kinds["vt"])

    def test_crop_keeps_a_part_in_the_coordinates_of_the_scene(self):
        for crop, inside in [("box:-1,-1,-9,1,1,9", lambda x, y: max(abs(x), abs(y)) < 1.2),
                             ("sphere:0,0,1,1.5", lambda x, y: x * x + y * y < 1.7**2)]:  # fmt: skip
            file = self.dir / "part.obj"
            self.run_program("mesh", self.out, "-o", file, "--renders", 8, "--texture", 0, "--crop", crop)
            places = [line.split()[1:3] for line in file.read_text().splitlines() if line.startswith("v ")]
            self.assertGreater(len(places), 100)
            outside = sum(not inside(float(x), float(y)) for x, y in places)
            self.assertLess(outside, 0.05 * len(places), crop)
        self.assertFalse((self.dir / "part.mtl").exists())

    def test_errors_name_the_fix(self):
        self.error_of("mesh", self.out, "-o", self.dir / "room.stl", code=2, names=["room.stl", ".glb", ".obj"])
        self.error_of("mesh", self.out, "--triangles", 1, code=2, names=["--triangles", "100"])
        self.error_of("mesh", self.out, "--texture", 16385, code=2, names=["--texture", "16384"])
        self.error_of("mesh", self.out, "--texture", 1024, code=2, names=["mesh.ply", ".glb"])
        self.error_of("mesh", self.out, "--crop", "sphere:99,99,99,1", code=2, names=["--crop"])
        self.error_of("mesh", self.out, "--crop", "cube", code=2, names=["--crop", "box:"])
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
        self.run_program("render", self.out, "--path", "spiral", "--what", "color,depth,normals,support,uncertainty", *frames)
        folder = self.out / "renders/spiral"
        for value in ["", "depth", "normals", "support", "uncertainty"]:
            width, height, channels, pixels = read_png(folder / value / "0001.png")
            self.assertEqual((width, height, channels), (120, 90, 3))
            self.assertGreater(len(set(pixels)), 8, value)
        self.run_program("render", self.out, "--path", "interpolate", "--what", "depth", *frames)
        self.assertEqual(len(list((self.out / "renders/interpolate/depth").glob("*.png"))), 3)
        self.error_of("render", self.out, "--what", "depths", code=2, names=["--what", "normals"])


if __name__ == "__main__":
    main()

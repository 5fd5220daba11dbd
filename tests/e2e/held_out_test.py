"""Test views reach nothing but the scores: without their images the same splat comes out."""

import json
import math
import shutil
import subprocess
import unittest

from harness import EndToEnd, command, main

TRAIN, TEST = range(0, 20, 2), range(1, 20, 4)  # the other five stay for proposals
RUN = ["--iterations", 40, "--max-gaussians", 1500, "--set", "refine-start=10", "--set", "refine-every=10", "--set", "stereo-iterations=3",
       "--set", "stereo-passes=1", "--proposers", "proxies,warp", "--proposals", 4, "--threads", 2]  # fmt: skip


def world_to_camera(frame):
    """Quaternion (w, x, y, z) and translation as COLMAP has them, of a camera-to-world matrix with OpenGL axes."""
    m = frame["transform_matrix"]
    rotation = [[m[j][i] * (1 if i == 0 else -1) for j in range(3)] for i in range(3)]
    translation = [-sum(rotation[i][j] * m[j][3] for j in range(3)) for i in range(3)]
    r = rotation
    w = math.sqrt(max(0, 1 + r[0][0] + r[1][1] + r[2][2])) / 2
    x = math.copysign(math.sqrt(max(0, 1 + r[0][0] - r[1][1] - r[2][2])) / 2, r[2][1] - r[1][2])
    y = math.copysign(math.sqrt(max(0, 1 - r[0][0] + r[1][1] - r[2][2])) / 2, r[0][2] - r[2][0])
    z = math.copysign(math.sqrt(max(0, 1 - r[0][0] - r[1][1] + r[2][2])) / 2, r[1][0] - r[0][1])
    return [w, x, y, z], translation


class HeldOut(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.dir / "views"  # large enough that colmap finds points
        size = ["--demo-views", 20, "--width", 240, "--height", 180, "--samples", 1]
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *size), check=True)

    def as_transforms(self, folder):
        shutil.copytree(self.scene, folder)
        return [frame["file_path"] for frame in self.frames()]

    def as_colmap(self, folder):
        """With points that all images see, and that are wrong."""
        shutil.copytree(self.scene / "images", folder / "images")
        transforms, model = self.transforms(), folder / "sparse" / "0"
        model.mkdir(parents=True)
        w, h, f = transforms["w"], transforms["h"], transforms["fl_x"]
        (model / "cameras.txt").write_text(f"1 PINHOLE {w} {h} {f} {f} {transforms['cx']} {transforms['cy']}\n")
        images, names = "", []
        for number, frame in enumerate(self.frames(), 1):
            names.append(frame["file_path"].split("/")[-1])
            quaternion, translation = world_to_camera(frame)
            images += " ".join(map(str, [number, *quaternion, *translation, 1, names[-1]])) + "\n"
            images += " ".join(f"{5 + p} 7 {p + 1}" for p in range(150)) + "\n"
        (model / "images.txt").write_text(images)
        track = " ".join(f"{number} {{0}}" for number in range(1, 21))
        points = [f"{p + 1} {p % 7} {p % 5} {p % 3} 9 9 9 0.5 {track.format(p)}" for p in range(150)]
        (model / "points3D.txt").write_text("\n".join(points) + "\n")
        return names

    def as_blender(self, folder):
        shutil.copytree(self.scene / "images", folder / "images")
        transforms = self.transforms()
        angle = 2 * math.atan(transforms["w"] / (2 * transforms["fl_x"]))
        names = [frame["file_path"] for frame in self.frames()]
        for part, views in {"train": [v for v in range(20) if v not in TEST], "test": TEST}.items():
            frames = [{"file_path": "./" + names[v].rsplit(".", 1)[0],
                       "transform_matrix": self.frames()[v]["transform_matrix"]} for v in views]  # fmt: skip
            (folder / f"transforms_{part}.json").write_text(json.dumps({"camera_angle_x": angle, "frames": frames}))
        return names

    def transforms(self):
        return json.loads((self.scene / "transforms.json").read_text())

    def frames(self):
        return sorted(self.transforms()["frames"], key=lambda frame: frame["file_path"])

    def compare(self, make):
        whole, bare = self.dir / f"{make.__name__}_whole", self.dir / f"{make.__name__}_bare"
        names = make(whole)
        shutil.copytree(whole, bare)
        for view in TEST:
            image = names[view].split("/")[-1]
            (bare / "images" / image).unlink()
        train = ["--train-views", ",".join(names[v] for v in TRAIN)]
        tests = ["--test-views", ",".join(names[v] for v in TEST)]
        outs = [self.dir / f"{make.__name__}_{i}" for i in range(2)]
        self.run_program("reconstruct", whole, "-o", outs[0], *train, *tests, *RUN)
        # colmap's matches differ from run to run: the second run takes over the first one's, if its inputs are the same.
        self.run_program("sfm", bare, "-o", outs[1], *train, "--test-every", 0, *RUN)
        inputs = [(out / "sfm" / "inputs.json").read_bytes() for out in outs]
        self.assertEqual(*inputs)
        shutil.rmtree(outs[1] / "sfm")
        shutil.copytree(outs[0] / "sfm", outs[1] / "sfm", symlinks=True)
        done = self.run_program("reconstruct", bare, "-o", outs[1], *train, "--test-every", 0, *RUN)
        self.assertNotIn("triangulated", done.stdout + done.stderr, "the points were not taken over")
        splits = [json.loads((out / "split.json").read_text()) for out in outs]
        self.assertEqual(splits[0]["train"], splits[1]["train"])
        self.assertEqual(len(splits[0]["test"]), len(TEST))
        self.assertEqual(splits[1]["test"], [])
        for file in ["proposals/transforms.json", "oracle.json", "sfm/dense.ply", "point_cloud.ply"]:
            with self.subTest(file):
                if (outs[0] / file).exists() or file == "point_cloud.ply":
                    self.assertEqual(*[(out / file).read_bytes() for out in outs])
        self.assertGreater(len(list((outs[0] / "confidence").glob("*.png"))), 0, "no proposal was validated")

    def test_transforms(self):
        self.compare(self.as_transforms)

    def test_colmap(self):
        self.compare(self.as_colmap)

    def test_blender(self):
        self.compare(self.as_blender)

    def test_the_models_points_are_an_option(self):
        scene = self.dir / "model_points"
        names = self.as_colmap(scene)
        split = ["--train-views", ",".join(names[v] for v in TRAIN), "--test-views", names[1]]
        done = self.run_program("sfm", scene, "-o", self.dir / "model_out", *split, "--set", "sfm-points=model")
        self.assertFalse((self.dir / "model_out" / "sfm" / "inputs.json").exists())
        self.assertIn("150", done.stdout)
        self.assertNotIn("images_", done.stderr)
        done = self.run_program("sfm", scene, "-o", self.dir / "small", *split, "--set", "sfm-points=model", "--downscale", 2)
        self.assertIn("has no folder images_2; the photos are resized here", done.stderr)
        required = ["--downscale", 2, "--set", "smaller-copies=required"]
        self.error_of("sfm", scene, "-o", self.dir / "refused", *split, *required, code=3, names=["no folder images_2"])
        self.assertFalse((self.dir / "refused").exists())

    def test_lists_in_files(self):
        """A run's own split.json, and a file with a name a line, give that split again."""
        out = self.dir / "first"
        self.run_program("sfm", self.scene, "-o", out, "--views", 5, "--test-every", 7)
        split = out / "split.json"
        lines = self.dir / "train.txt"
        lines.write_text("\n".join(json.loads(split.read_text())["train"]))
        for i, train in enumerate([split, lines]):
            again = self.dir / f"again{i}"
            lists = ["--train-views", f"@{train}", "--test-views", f"@{split}"]
            self.run_program("sfm", self.scene, "-o", again, *lists)
            self.assertEqual((again / "split.json").read_text(), split.read_text())
        lines.unlink()  # the run no longer needs it
        self.run_program("info", self.dir / "again1")

    def test_splits_that_cannot_be(self):
        out = self.dir / "none"
        names = [frame["file_path"] for frame in self.frames()]
        for options, said in [(["--train-views", f"{names[0]},{names[1]}", "--test-views", names[1]], names[1]),
                              (["--train-views", "nobody"], "nobody"), (["--train-views", names[0]], "2 or more"),
                              (["--train-views", ":99,:1"], ":99"), (["--train-views", "@/nowhere"], "/nowhere"),
                              (["--train-views", ":1,:2", "--views", 3], "--views")]:  # fmt: skip
            with self.subTest(options):
                self.error_of("reconstruct", self.scene, "-o", out, *options, code=3, names=[said])
                self.assertFalse(out.exists())


if __name__ == "__main__":
    main()

"""Poses that come with a scene are checked before anything is trained: right, a little wrong, and the usual mistakes."""

import json
import math
import random
import shutil
import subprocess

from harness import EndToEnd, command, main

SIZE = ["--demo-views", 9, "--width", 320, "--height", 240, "--samples", 1]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def diagonal(*values):
    return [[values[i] if i == j else 0 for j in range(4)] for i in range(4)]


def turned(matrix, degrees, rng):
    """The camera turned about an axis of its own, and moved by a hundredth of its distance from the origin."""
    axis = [rng.gauss(0, 1) for _ in range(3)]
    norm = math.hypot(*axis)
    x, y, z = (a / norm for a in axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    turn = [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s, 0],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s, 0],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c), 0], [0, 0, 0, 1]]  # fmt: skip
    moved = product(matrix, turn)
    distance = math.hypot(*(row[3] for row in matrix[:3]))
    for row in moved[:3]:
        row[3] += rng.choice([-1, 1]) * 0.01 * distance / math.sqrt(3)
    return moved


class GivenPoses(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.dir / "textured"
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *SIZE), check=True)

    def changed(self, name, change):
        scene = self.copy_scene(name)

        def edit(transforms):
            frames = sorted(transforms["frames"], key=lambda frame: frame["file_path"])
            matrices = change([frame["transform_matrix"] for frame in frames])
            for frame, matrix in zip(frames, matrices, strict=True):
                frame["transform_matrix"] = matrix

        self.edit_transforms(scene, edit)
        return scene

    def test_true_poses_are_quiet(self):
        done = self.run_program("sfm", self.scene, "-o", self.dir / "true")
        self.assertNotIn("given poses", done.stdout + done.stderr)
        record = json.loads((self.dir / "true/stages.json").read_text())["sfm"]
        self.assertEqual(record["poses"]["verdict"], "fit")

    def test_small_errors_are_named(self):
        rng = random.Random(3)
        scene = self.changed("perturbed", lambda matrices: [turned(matrix, 0.3, rng) for matrix in matrices])
        done = self.run_program("sfm", scene, "-o", self.dir / "perturbed_out")
        self.assertIn("the given poses are a little wrong", done.stderr + done.stdout)

    def test_mistakes_end_the_run_unless_forced(self):
        scene = self.changed("opencv", lambda matrices: [product(m, diagonal(1, -1, -1, 1)) for m in matrices])
        out = self.dir / "opencv_out"
        self.error_of("sfm", scene, "-o", out, code=3, names=["with the axes of OpenCV", "negate", "--force"])
        done = self.run_program("sfm", scene, "-o", out, "--force")
        self.assertIn("with the axes of OpenCV", done.stderr + done.stdout)
        shutil.rmtree(out)
        scene = self.changed("shifted", lambda matrices: matrices[1:] + matrices[:1])
        self.error_of("sfm", scene, "-o", out, code=3, names=["in another order", "its own pose"])


if __name__ == "__main__":
    main()

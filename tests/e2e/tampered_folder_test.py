"""A folder of proposals that nothing is known of, given alone: what is tampered with, and what is wrong as a whole."""

import json
import math
import random
import shutil
import subprocess
import unittest

from harness import EndToEnd, command, main, png, read_png, write_png

WIDTH, HEIGHT = 128, 96
RUN = ["--views", 10, "--test-every", 4, "--set", "stereo-iterations=3", "--set", "stereo-passes=1", "--iterations", 60,
       "--max-gaussians", 1500, "--proposers", "none"]  # fmt: skip


def tampered(pixels, other, rng):
    """About a third of the pixels replaced in discs and boxes, and which of them moved visibly."""
    changed, parts = bytearray(pixels), bytearray(WIDTH * HEIGHT)
    while sum(parts) < 0.31 * len(parts):
        kind, disc, radius = rng.choice(["other", "elsewhere", "tone"]), rng.random() < 0.5, rng.uniform(6, 20)
        x0, y0 = rng.uniform(0, WIDTH), rng.uniform(0, HEIGHT)
        dx, dy = rng.randrange(WIDTH // 4, WIDTH // 2), rng.randrange(HEIGHT // 4, HEIGHT // 2)
        gains = [rng.choice([0.6, 1.5]) for _ in range(3)]
        for y in range(max(0, int(y0 - radius)), min(HEIGHT, int(y0 + radius) + 1)):
            for x in range(max(0, int(x0 - radius)), min(WIDTH, int(x0 + radius) + 1)):
                if disc and math.hypot(x - x0, y - y0) > radius:
                    continue
                i, j = y * WIDTH + x, (y + dy) % HEIGHT * WIDTH + (x + dx) % WIDTH
                source = other if kind == "other" else pixels
                for c in range(3):
                    changed[3 * i + c] = (
                        min(255, int(pixels[3 * i + c] * gains[c])) if kind == "tone" else source[3 * j + c]
                    )
                parts[i] = 1
    return changed, [max(abs(changed[3 * i + c] - pixels[3 * i + c]) for c in range(3)) > 20 for i in range(len(parts))]


def auroc(confidence, mask):
    """How often a pixel of the mask has less confidence than another one."""
    inside, outside = [0] * 256, [0] * 256
    for value, is_inside in zip(confidence, mask):
        (inside if is_inside else outside)[value] += 1
    below = pairs = 0
    for value in range(256):
        pairs += outside[value] * (below + inside[value] / 2)
        below += inside[value]
    return pairs / sum(inside) / sum(outside)


class TamperedFolder(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.dir / "views"
        size = ["--demo-views", 24, "--width", WIDTH, "--height", HEIGHT, "--samples", 1]
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *size), check=True)
        out = cls.dir / "split"
        subprocess.run(command("sfm", cls.scene, "-o", out, "--quiet", *RUN), check=True)
        split = json.loads((out / "split.json").read_text())
        used = {name.rsplit("/", 1)[-1] for part in ("train", "test") for name in split[part]}
        cls.spare = [path for path in sorted((cls.scene / "images").iterdir()) if path.name not in used]

    def folder(self, name, pictures):
        folder = self.dir / name / "synthetic_1"
        folder.mkdir(parents=True)
        for file, picture in pictures.items():
            (folder / file).write_bytes(picture)
        return folder.parent

    def test_trusts_what_is_tampered_with_least(self):
        rng = random.Random(5)
        pictures, masks = {}, {}
        for path, other in zip(self.spare, self.spare[3:] + self.spare[:3]):
            changed, mask = tampered(read_png(path)[3], read_png(other)[3], rng)
            pictures[path.name], masks[path.stem] = write_png(WIDTH, HEIGHT, 3, changed), mask
        out = self.dir / "tampered"
        done = self.run_program("validate", self.scene, "-o", out, *RUN, "--proposal-folder",
                                self.folder("lies", pictures))  # fmt: skip
        self.assertNotIn("no confidence anywhere", done.stderr)
        confidence, mask = [], []
        for path in sorted((out / "confidence").glob("*.png")):
            confidence += read_png(path)[3]
            mask += next(of_one for name, of_one in masks.items() if path.stem.endswith(name))
        self.assertEqual(len(confidence), len(self.spare) * WIDTH * HEIGHT)
        self.assertGreater(auroc(confidence, mask), 0.9)

    def test_names_pictures_that_are_wrong_as_a_whole_and_trains_without_them(self):
        names = [path.name for path in self.spare]
        pixels = read_png(self.spare[1])[3]
        turned = b"".join(bytes(pixels[i : i + 3]) for i in range(len(pixels) - 3, -1, -3))
        wrong = {
            names[0]: png(WIDTH, HEIGHT, (120, 100, 90)),
            names[1]: write_png(WIDTH, HEIGHT, 3, turned),
            names[2]: self.spare[-1].read_bytes(),  # another pose
        }
        out = self.dir / "wrong"
        pictures = {**wrong, names[4]: self.spare[4].read_bytes()}
        done = self.run_program("validate", self.scene, "-o", out, *RUN, "--proposal-folder",
                                self.folder("some", pictures))  # fmt: skip
        warnings = [line for line in done.stderr.splitlines() if "3 of 4 proposals have no confidence anywhere" in line]
        self.assertEqual(len(warnings), 1, done.stderr)
        for name in names[:3]:
            self.assertIn(name.removesuffix(".png"), warnings[0])
        self.assertNotIn(names[4].removesuffix(".png"), warnings[0])
        self.assertIn("check scene, pose, scale and orientation", warnings[0])

        all_wrong, alone = self.dir / "all_wrong", self.dir / "alone"
        self.run_program("depth", self.scene, "-o", alone, *RUN)  # once for both: COLMAP's matching varies
        shutil.copytree(alone, all_wrong)
        self.run_program("reconstruct", self.scene, "-o", all_wrong, *RUN, "--proposal-folder",
                         self.folder("all", wrong))  # fmt: skip
        self.run_program("reconstruct", self.scene, "-o", alone, *RUN)
        models = [(out / "point_cloud.ply").read_bytes() for out in (all_wrong, alone)]
        self.assertEqual(models[0], models[1], "the photos alone are trained on")


if __name__ == "__main__":
    main()

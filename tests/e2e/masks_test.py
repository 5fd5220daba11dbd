"""--masks from the outside: the example that ships, what a command may do wrong, and no halo around soft edges."""

import shlex
import subprocess
import sys
import unittest

from harness import ROOT, EndToEnd, command, main, read_png, write_png

EXAMPLE = f"{shlex.quote(sys.executable)} {shlex.quote(str(ROOT / 'examples/masks/plain_backdrop/mask.py'))} {{request}} {{answer}}"
RUN = ["--test-every", 4, "--proposers", "none", "--set", "stereo-iterations=3", "--set", "stereo-passes=1",
       "--max-gaussians", 4000, "--no-report"]  # fmt: skip
MOST_OPACITY = 0.05
RING = 3  # pixels outside the mask


def near(mask, width, height, x, y):
    """Whether a black pixel is within RING of the edge."""
    return any(mask[v * width + u] > 0
               for v in range(max(0, y - RING), min(height, y + RING + 1))
               for u in range(max(0, x - RING), min(width, x + RING + 1))
               if (u - x) ** 2 + (v - y) ** 2 <= RING * RING)  # fmt: skip


class Masks(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.dir / "object"
        size = ["--kind", "object", "--demo-views", 16, "--width", 120, "--height", 90, "--samples", 2]
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *size), check=True)

    def soften(self, folder, ramp=5):
        """The edges of all masks become ramps of this many pixels."""
        for path in folder.glob("*.png"):
            width, height, _, mask = read_png(path)
            for step in range(2):  # a box filter along the rows, then along the columns
                stride, count = (1, width) if step == 0 else (width, height)
                soft = bytearray(len(mask))
                for line in range(len(mask) // count):
                    begin = line * width if step == 0 else line
                    for i in range(count):
                        taken = [mask[begin + stride * min(count - 1, max(0, i + d))] for d in range(-(ramp // 2), ramp // 2 + 1)]
                        soft[begin + stride * i] = sum(taken) // len(taken)
                mask = soft
            path.write_bytes(write_png(width, height, 1, mask))

    def render(self, out, background):
        """The test views of a splat before a background."""
        shown = self.dir / f"{out.name} before {background}"
        self.run_program("render", self.scene, "--ply", out / "point_cloud.ply", "-o", shown, "--path", "test", "--test-every", 4,
                         "--background", background, "--no-video")  # fmt: skip
        return [read_png(path)[3] for path in sorted(shown.glob("*.png"))]

    def opacity_beside(self, out, masks):
        """Mean opacity where the masks are black, near their edges."""
        total = pixels = 0
        files = sorted(masks.glob("*.png"))[::4]
        for path, black, white in zip(files, self.render(out, "black"), self.render(out, "white"), strict=True):
            width, height, _, mask = read_png(path)
            for i, value in enumerate(mask):
                if value == 0 and near(mask, width, height, i % width, i // width):
                    total += 1 - sum(white[3 * i + c] - black[3 * i + c] for c in range(3)) / 765
                    pixels += 1
        self.assertGreater(pixels, 500)
        return total / pixels

    def test_the_example_masks_the_object_once(self):
        out = self.dir / "example"
        first = self.run_program("reconstruct", self.scene, "-o", out, *RUN, "--iterations", 60, "--masks", EXAMPLE)
        self.assertIn("16 masks", first.stdout)
        _, _, _, mask = read_png(out / "masks/images_000.png")
        used = sum(value == 255 for value in mask) / len(mask)
        self.assertTrue(0.1 < used < 0.5, used)
        before = (out / "masks/images_000.png").stat().st_mtime_ns
        self.run_program("reconstruct", self.scene, "-o", out, *RUN, "--iterations", 60, "--masks", EXAMPLE)
        self.assertEqual((out / "masks/images_000.png").stat().st_mtime_ns, before, "made once")

    def test_soft_edges_leave_no_halo(self):
        masks = self.dir / "soft"
        masks.mkdir()
        example = EXAMPLE.format(request=shlex.quote(str(self.scene / "images")), answer=shlex.quote(str(masks)))
        subprocess.run(example, shell=True, check=True, stdout=subprocess.DEVNULL)
        self.soften(masks)
        out = self.dir / "without halo"
        answers = f"for i in {{request}}/*; do cp {shlex.quote(str(masks))}/${{i##*images_}} {{answer}}/${{i##*/}}; done"
        self.run_program("reconstruct", self.scene, "-o", out, *RUN, "--iterations", 1000, "--masks", answers)
        self.assertLessEqual(self.opacity_beside(out, masks), MOST_OPACITY)

    def test_what_goes_wrong_is_one_line(self):
        def error_of(masks, *more, **expected):
            return self.error_of("reconstruct", self.scene, "-o", self.dir / "wrong", *RUN, "--iterations", 20, *more, "--masks", masks, **expected)

        error_of("echo no memory >&2; exit 7", code=4, names=["--masks", "exit code 7", "no memory", "log.txt"])
        error_of("cp {request}/*0.png {answer}", code=3, names=["images_001.png: is missing", "wrote 2 of 16"])
        error_of("sleep 60", "--generator-timeout", 1, code=4, names=["stopped after 1 s, when 0 of 16"])
        error_of("for i in {request}/*; do echo no image > {answer}/${i##*/}; done", code=3, names=["images_0"])


if __name__ == "__main__":
    main()

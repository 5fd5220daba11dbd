#!/usr/bin/env python3
"""Exports drawn by Spark and by three.js in headless Chromium (tests/foreign/viewers.mjs), beside the program's own renders."""

import json
import math
import re
import struct
import subprocess

from harness import ROOT, SMALL_RUN, EndToEnd, main, png, read_png

FOREIGN = ROOT / "tests/foreign"
ENDS = [".ply", ".compressed.ply", ".spz", ".sog", ".glb", ".splat"]
FILES = [*(f"run{end}" for end in ENDS), "four.spz"]
NOT_READ = {"spark four.spz", "spark run.glb", "spark sign.glb"}  # by these versions

# A sign of dots, one Gaussian each: letters none of which is its own mirror image, and a rod from a red to a blue end.
LETTERS = {"F": "11111 10000 10000 11110 10000 10000 10000", "7": "11111 00001 00010 00100 01000 01000 01000", "R": "11110 10001 10001 11110 10100 10010 10001"}
TEXT, PITCH = "F7R", 0.08  # m between dots
ROD_DEPTH, ROD_BELOW = 0.4, 0.5  # m from the middle of the text: towards the viewer, and down
UNIT = 0.5  # m; what the model of the test is in


def text_dots():
    """(letter, row, column, place in meters) of every dot of the text, lit or not; x right, y down, z forward."""
    width = 6 * len(TEXT) - 1
    for k in range(len(TEXT)):
        for row in range(7):
            for column in range(5):
                yield k, row, column, (PITCH * (6 * k + column - (width - 1) / 2), PITCH * (row - 3), 0.0)


def write_sign(path):
    """The sign as the PLY of a model whose units are not meters, and says so."""
    dots = [(place, (1, 1, 1)) for k, row, column, place in text_dots() if LETTERS[TEXT[k]].split()[row][column] == "1"]
    ends = {-0.5: (1, 0, 0), 0.5: (0, 0, 1)}  # m; the green between them does not touch them
    dots += [((x, ROD_BELOW, -ROD_DEPTH), ends.get(x, (0, 0.5, 0))) for x in [*ends, *(0.05 * i for i in range(-7, 8))]]
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    header = f"ply\nformat binary_little_endian 1.0\ncomment a unit is {UNIT} m\nelement vertex {len(dots)}\n"
    header += "".join(f"property float {name}\n" for name in names) + "end_header\n"
    size = math.log(0.018 / UNIT)
    rows = [[x / UNIT for x in place] + [(c - 0.5) / 0.28209479177387814 for c in color] + [6, size, size, size, 1, 0, 0, 0] for place, color in dots]
    path.write_bytes(header.encode() + b"".join(struct.pack("<14f", *row) for row in rows))


class Picture:
    """A picture from a pose: camera-to-world with OpenGL's camera axes, in meters."""

    def __init__(self, path, matrix, focal):
        self.width, self.height, self.channels, self.data = read_png(path)
        self.matrix, self.focal = matrix, focal

    def pixel_of(self, place):
        way = [place[r] - self.matrix[r][3] for r in range(3)]
        x, y, z = (sum(self.matrix[r][c] * way[r] for r in range(3)) for c in range(3))
        return self.width / 2 - self.focal * x / z, self.height / 2 + self.focal * y / z

    def at(self, x, y):
        begin = self.channels * (self.width * int(y) + int(x))
        return self.data[begin : begin + 3]

    def text(self):
        """What the picture reads where the text should be."""
        found = [[["0"] * 5 for _ in range(7)] for _ in TEXT]
        for k, row, column, place in text_dots():
            found[k][row][column] = "1" if min(self.at(*self.pixel_of(place))) > 128 else "0"
        shapes = {shape: letter for letter, shape in LETTERS.items()}
        return "".join(shapes.get(" ".join("".join(row) for row in letter), "?") for letter in found)

    def middle_of(self, channel):
        """The middle of what has this color alone, weighted by its brightness."""
        total = x_sum = y_sum = 0
        for y in range(self.height):
            for x in range(self.width):
                color = self.at(x, y)
                weight = max(0, color[channel] - max(color[c] for c in range(3) if c != channel) - 30)
                total, x_sum, y_sum = total + weight, x_sum + weight * (x + 0.5), y_sum + weight * (y + 0.5)
        return x_sum / total, y_sum / total


def looking_at_the_sign(turn):
    """A pose 2.5 m from the middle of the text, turned about the vertical, to its left for an angle above zero; y is down in the world."""
    c, s = math.cos(turn), math.sin(turn)
    # Columns: right, up, backwards, center.
    return [[c, 0, -s, -2.5 * s], [0, -1, 0, 0], [-s, 0, -c, -2.5 * c], [0, 0, 0, 1]]


class Viewers(EndToEnd):
    def scores_of(self, job):
        packages = FOREIGN / "node_modules"
        self.assertTrue(packages.is_dir(), f"the viewers are not installed: run scripts/test.sh once, or npm ci --prefix {FOREIGN}")
        path = self.dir / "job.json"
        path.write_text(json.dumps({**job, "not_read": sorted(NOT_READ)}))
        done = subprocess.run(["node", FOREIGN / "viewers.mjs", path], capture_output=True, text=True, timeout=400, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def test_other_viewers_show_what_the_program_renders(self):
        out, drawn = self.dir / "run", self.dir / "drawn"
        self.run_program("reconstruct", self.scene, "-o", out, *SMALL_RUN)
        for name in FILES:
            self.run_program("export", out, "-o", self.dir / name, *(["--spz-version", 4] if name == "four.spz" else []))
        self.run_program("render", out, "--path", "test", "-o", drawn, "--no-video")

        scene = json.loads((self.scene / "transforms.json").read_text())
        matrices = {frame["file_path"]: frame["transform_matrix"] for frame in scene["frames"]}
        tests = json.loads((out / "split.json").read_text())["test"]
        poses = [{"matrix": matrices[name], "image": str(drawn / name.replace("/", "_"))} for name in tests]
        size = {"width": scene["w"], "height": scene["h"], "fov": 2 * math.degrees(math.atan(scene["h"] / 2 / scene["fl_y"]))}
        self.assertGreater(len(poses), 1)

        scores = self.scores_of({**size, "files": [str(self.dir / name) for name in FILES], "poses": poses})
        self.assertEqual(len(scores), 10)
        for name, score in scores.items():
            with self.subTest(name):
                # So few Gaussians are large, and these viewers cut large ones off; a picture that is mirrored, turned or in
                # other colors has 12 dB.
                self.assertGreater(min(score["psnr"]), 20)
                self.assertGreater(min(score["alike"]), 36)  # what the format loses

    def test_text_is_not_mirrored_and_a_meter_is_a_meter(self):
        width, height, focal = 320, 240, 280
        matrices = [looking_at_the_sign(turn) for turn in (0, 0.5)]
        sign, drawn, scene = self.dir / "units.ply", self.dir / "sign_drawn", self.dir / "sign_scene"
        write_sign(sign)
        files = [self.dir / f"sign{end}" for end in ENDS]
        for file in files:
            self.run_program("convert", sign, file)
        # The poses as a scene, in meters, for the program's own renders.
        scene.mkdir()
        frames = [{"file_path": f"{i}.png", "transform_matrix": matrix} for i, matrix in enumerate(matrices)]
        for frame in frames:
            (scene / frame["file_path"]).write_bytes(png(width, height, (0, 0, 0)))
        (scene / "transforms.json").write_text(json.dumps({"w": width, "h": height, "fl_x": focal, "fl_y": focal, "frames": frames}))
        self.run_program("render", scene, "--ply", files[0], "--path", "train", "-o", drawn, "--no-video")

        pictures = {"oraclegs": [drawn / frame["file_path"] for frame in frames]}
        poses = [{"matrix": matrix, "image": str(image)} for matrix, image in zip(matrices, pictures["oraclegs"])]
        fov = 2 * math.degrees(math.atan(height / 2 / focal))
        scores = self.scores_of({"width": width, "height": height, "fov": fov, "files": list(map(str, files)), "poses": poses})
        self.assertEqual(len(scores), 9)
        for name in scores:
            viewer, file = name.split()
            pictures[name] = [self.dir / f"{file}.{viewer}.{i}.png" for i in range(len(poses))]
        for name, paths in pictures.items():
            for path, matrix in zip(paths, matrices):
                with self.subTest(name, picture=path.name):
                    picture = Picture(path, matrix, focal)
                    self.assertEqual(picture.text(), TEXT)
                    ends = [picture.middle_of(channel) for channel in (0, 2)]
                    expected = [picture.pixel_of((x, ROD_BELOW, -ROD_DEPTH)) for x in (-0.5, 0.5)]
                    self.assertAlmostEqual(math.dist(*ends) / math.dist(*expected), 1, delta=0.01)
                    for end, place in zip(ends, expected):
                        self.assertLess(math.dist(end, place), 1)

    def test_usd_says_that_its_units_are_meters(self):
        sign, text = self.dir / "usd_units.ply", self.dir / "sign.usda"
        write_sign(sign)
        for scale, meters in (("auto", 1), (1, UNIT)):
            self.run_program("convert", sign, text, "--scale", scale, "--overwrite")
            words = text.read_text()
            self.assertEqual(float(re.search(r"metersPerUnit = (\S+)", words).group(1)), meters)
            places = re.search(r"positions = \[(.*?)\]\n", words, re.S).group(1)
            x = [float(place.split(",")[0]) for place in re.findall(r"\(([^)]*)\)", places)][-17:]
            self.assertAlmostEqual((max(x) - min(x)) * meters, 1, places=4)


if __name__ == "__main__":
    main()

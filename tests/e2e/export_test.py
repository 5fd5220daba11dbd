#!/usr/bin/env python3
"""Exports and conversions in every format, opened by programs of others (tests/foreign), and what they refuse."""

import json
import math
import random
import struct
import subprocess
import zipfile

from harness import ROOT, EndToEnd, main

FOREIGN = ROOT / "tests/foreign"
SH0 = 0.28209479177387814
DEGREE = 2
REST = 3 * ((DEGREE + 1) ** 2 - 1)
NAMES = ["x", "y", "z", *(f"f_dc_{i}" for i in range(3)), *(f"f_rest_{i}" for i in range(REST)), "opacity",
         *(f"scale_{i}" for i in range(3)), *(f"rot_{i}" for i in range(4))]  # fmt: skip


def write_ply(path, rows, support=False):
    """A splat of these Gaussians, each a dictionary."""
    names = NAMES + (["support"] if support else [])
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n"
    header += "".join(f"property float {name}\n" for name in names) + "end_header\n"
    path.write_bytes(header.encode() + b"".join(struct.pack(f"<{len(names)}f", *(row[n] for n in names)) for row in rows))


def read_ply(path):
    """The Gaussians of a binary PLY of floats, which all programs write."""
    data = path.read_bytes()
    body = data.index(b"end_header\n") + 11
    lines = data[:body].decode().splitlines()
    names = [line.split()[2] for line in lines if line.startswith("property float")]
    assert len(names) == sum(line.startswith("property") for line in lines), lines
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    return [dict(zip(names, struct.unpack_from(f"<{len(names)}f", data, body + 4 * len(names) * i))) for i in range(count)]


def some_gaussians(count):
    draw = random.Random(7)
    rows = []
    for _ in range(count):
        row = {name: draw.gauss(0, 0.1) for name in NAMES}
        row.update({name: draw.gauss(0, 1) for name in ["x", "y", "z", "rot_0", "rot_1", "rot_2", "rot_3"]})
        row.update({f"f_dc_{i}": draw.uniform(-1.5, 1.5) for i in range(3)})
        row.update({f"scale_{i}": draw.gauss(-4, 0.5) for i in range(3)})
        row["opacity"] = draw.uniform(-1, 5)
        row["support"] = draw.random()
        rows.append(row)
    return rows


def place(row):
    return (row["x"], row["y"], row["z"])


def rotation(row):
    q = [row[f"rot_{i}"] for i in range(4)]
    return [c / math.sqrt(sum(d * d for d in q)) for c in q]


def turn_between(p, q):
    """The largest difference of two quaternions that describe one Gaussian: half turns about its axes and signs are free."""
    w, x, y, z = q
    same = [(w, x, y, z), (-x, w, z, -y), (-y, -z, w, x), (-z, y, -x, w)]
    return min(max(abs(a - sign * b) for a, b in zip(p, r)) for r in same for sign in (1, -1))


def sigmoid(x):
    return 1 / (1 + math.exp(-x))


def distances(expected, found):
    """The largest difference of each attribute, Gaussians paired by their places."""
    far = dict.fromkeys(["place", "scale", "color", "opacity", "rotation", "rest"], 0.0)
    for a in expected:
        b = min(found, key=lambda row: math.dist(place(a), place(row)))
        rest = [abs(a[f"f_rest_{i}"] - b[f"f_rest_{i}"]) for i in range(REST)] if "f_rest_0" in b else [0]
        here = {
            "place": math.dist(place(a), place(b)),
            "scale": max(abs(a[f"scale_{i}"] - b[f"scale_{i}"]) for i in range(3)),
            "color": max(abs(a[f"f_dc_{i}"] - b[f"f_dc_{i}"]) for i in range(3)) * SH0,
            "opacity": abs(sigmoid(a["opacity"]) - sigmoid(b["opacity"])),
            "rotation": turn_between(rotation(a), rotation(b)),
            "rest": max(rest),
        }
        far = {name: max(value, here[name]) for name, value in far.items()}
    return far


# What a format may lose, by the bounds of docs/formats.md.
LIMITS = {
    ".spz": {"place": 0.002, "scale": 0.032, "color": 0.004, "opacity": 0.002, "rotation": 0.003, "rest": 0.016},
    ".sog": {"place": 0.001, "scale": 0.1, "color": 0.02, "opacity": 0.002, "rotation": 0.012, "rest": 0.6},
    ".compressed.ply": {"place": 0.006, "scale": 0.003, "color": 0.003, "opacity": 0.002, "rotation": 0.003, "rest": 0.016},
    ".splat": {"place": 1e-6, "scale": 1e-5, "color": 0.002, "opacity": 0.002, "rotation": 0.012, "rest": 1},
    ".glb": {"place": 1e-6, "scale": 1e-5, "color": 1e-6, "opacity": 1e-5, "rotation": 1e-5, "rest": 1e-6},
    ".usda": {"place": 1e-6, "scale": 1e-5, "color": 1e-6, "opacity": 1e-5, "rotation": 1e-5, "rest": 1e-6},
    ".usdz": {"place": 1e-6, "scale": 1e-5, "color": 1e-6, "opacity": 1e-5, "rotation": 1e-5, "rest": 1e-6},
    ".spz.glb": {"place": 0.002, "scale": 0.032, "color": 0.004, "opacity": 0.002, "rotation": 0.13, "rest": 0.016},
}


class Export(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.rows = some_gaussians(300)
        cls.ply = cls.dir / "in.ply"
        write_ply(cls.ply, cls.rows, support=True)

    def node(self, *arguments):
        packages = FOREIGN / "node_modules"
        self.assertTrue(packages.is_dir(), f"foreign readers are not installed: run scripts/test.sh once, or npm ci --prefix {FOREIGN}")
        done = subprocess.run(["node", *map(str, arguments)], cwd=FOREIGN, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def splat_transform(self, *arguments):
        return self.node("node_modules/@playcanvas/splat-transform/bin/cli.mjs", "--quiet", "--overwrite", *arguments)

    def assertNear(self, expected, found, limits):
        self.assertEqual(len(found), len(expected))
        for name, far in distances(expected, found).items():
            self.assertLessEqual(far, limits[name], name)

    def export(self, extension, *arguments):
        out = self.dir / f"out{extension}"
        said = self.run_program("export", self.ply, "-o", out, *arguments).stdout
        self.assertIn(f"{extension}, {out.stat().st_size / 1e6:.2f} MB, {300 if not arguments else ''}", said)
        return out

    def test_another_program_reads_what_it_should(self):
        for extension, *arguments in [[".spz"], [".spz", "--spz-version", 4], [".sog"], [".compressed.ply"], [".splat"]]:
            with self.subTest(extension, arguments=arguments):
                back = self.dir / "foreign.ply"
                self.splat_transform(self.export(extension, *arguments), back)
                self.assertNear(self.rows, read_ply(back), LIMITS[extension])

    def test_reads_back_what_it_wrote(self):
        for extension, limits in LIMITS.items():
            with self.subTest(extension):
                back = self.dir / "back.ply"
                self.run_program("export", self.export(extension), "-o", back)
                found = read_ply(back)
                self.assertNear(self.rows, found, limits)
                self.assertEqual("support" in found[0], extension in [".sog", ".glb"])

    def test_reads_what_another_program_wrote(self):
        plain = self.dir / "plain.ply"
        write_ply(plain, self.rows)
        for name, arguments in {"a.spz": ["--spz-version", "3"], "new.spz": [], "a.sog": ["--gpu", "cpu"], "a.compressed.ply": [], "a.glb": []}.items():
            with self.subTest(name):
                self.splat_transform(*arguments, plain, self.dir / name)
                back = self.dir / "back.ply"
                self.run_program("export", self.dir / name, "-o", back)
                coarse = {"place": 0.01, "scale": 0.1, "color": 0.03, "opacity": 0.005, "rotation": 0.02, "rest": 0.6}
                self.assertNear(self.rows, read_ply(back), coarse)

    def test_gltf_is_valid(self):
        for extension in [".glb", ".spz.glb"]:
            report = json.loads(self.node("validate_glb.mjs", self.export(extension)))
            # The validator is older than the extension, whose attributes it takes for misspelled ones; all else counts.
            names = [m for m in report["issues"]["messages"] if m["severity"] < 2]
            other = [m for m in names if m["code"] != "MESH_PRIMITIVE_INVALID_ATTRIBUTE" or "/KHR_gaussian_splatting:" not in m["pointer"]]
            self.assertEqual(other, [])
            self.assertEqual(report["info"]["extensionsUsed"][0], "KHR_gaussian_splatting")
            self.assertGreater(report["info"]["totalVertexCount"], 299)

    def test_another_program_reads_usd_and_writes_it_again(self):
        for extension in [".usda", ".usdz"]:
            with self.subTest(extension):
                foreign, back = self.dir / "foreign.usda", self.dir / "back.ply"
                self.node("rewrite_usd.mjs", self.export(extension), foreign)
                self.assertNotEqual(foreign.read_bytes(), (self.dir / "out.usda").read_bytes())
                self.run_program("export", foreign, "-o", back)
                self.assertNear(self.rows, read_ply(back), LIMITS[extension])

    def test_leaves_out_what_the_options_say(self):
        def kept(*arguments):
            return read_ply(self.export(".ply", *arguments))

        weak = [row for row in self.rows if row["support"] < 0.5]
        self.assertEqual(len(kept("--min-support", 0.5)), 300 - len(weak))
        self.assertEqual(len(kept("--max-gaussians", 7)), 7)
        inside = [row for row in self.rows if math.dist(place(row), (0.5, 0, 0)) <= 1]
        self.assertEqual(len(kept("--crop", "sphere:0.5,0,0,1")), len(inside))
        self.assertTrue(all(abs(row["x"]) <= 1 for row in kept("--crop", "box:-1,-9,-9,1,9,9")))
        turned = kept("--up", "z", "--scale", 2, "--max-gaussians", 1)[0]
        same = kept("--max-gaussians", 1)[0]
        self.assertAlmostEqual(turned["z"], -2 * same["y"], 4)
        plain = self.dir / "no_support.ply"
        write_ply(plain, self.rows)
        self.error_of("export", plain, "-o", self.dir / "x.ply", "--min-support", 0.5, code=3, names=[plain, "--min-support"])

    def test_refuses_before_it_reads(self):
        missing = self.dir / "missing.ply"
        out = self.error_of("export", missing, "-o", self.dir / "a.obj", code=2, names=["a.obj"])
        for extension in [".ply", ".compressed.ply", ".spz", ".sog", ".splat", ".glb"]:
            self.assertIn(extension, out)
        self.error_of("export", missing, "-o", self.dir, code=2, names=[self.dir, "is a folder"])
        self.error_of("export", missing, "-o", f"{self.dir}/new/", code=2, names=["is a folder"])
        self.error_of("export", self.ply, "-o", self.ply, code=2, names=["is the input itself"])
        self.error_of("export", self.ply, "-o", self.dir / "refused.spz", "--crop", "cube", code=2, names=["--crop", "sphere:"])
        self.error_of("export", self.ply, "-o", self.dir / "refused.spz", "--crop", "auto", code=2, names=["--crop auto", "workspace"])
        self.error_of("export", self.ply, "-o", self.dir / "refused.spz", "--up", "auto", code=2, names=["--up auto", "workspace"])
        self.error_of("export", self.ply, "-o", self.dir / "refused.spz", "--up", "w", code=2, names=["--up", "-z"])
        self.error_of("export", self.ply, "-o", self.dir / "refused.spz", "--scale", 0, code=2, names=["--scale"])
        self.assertFalse((self.dir / "refused.spz").exists())

    def test_convert_takes_one_file(self):
        out = self.dir / "one.spz"
        said = self.run_program("convert", self.ply, out, "--scale", 2).stdout
        self.assertRegex(said, rf"splat +{out} \(\.spz, [\d.]+ MB, 300 of 300 Gaussians, SH degree 2; loses 0\.\d\d dB of 30 dB\)")
        self.assertIn("loses nothing that is seen", self.run_program("convert", self.ply, self.dir / "one.glb").stdout)
        self.error_of("convert", self.ply, out, code=2, names=[out, "is there already", "--overwrite"])
        self.run_program("convert", self.ply, out, "--overwrite")
        self.run_program("convert", out, self.dir / "new/folder", "--format", ".compressed.ply")
        self.assertTrue((self.dir / "new/folder/one.compressed.ply").is_file())
        self.error_of("convert", self.ply, self.ply, code=2, names=["is the input itself"])
        self.error_of("convert", self.ply, code=2, names=["out"])

    def test_convert_takes_a_folder(self):
        folder, out = self.dir / "splats", self.dir / "small"
        (folder / "sog").mkdir(parents=True)
        write_ply(folder / "a.ply", self.rows[:100])
        self.run_program("convert", folder / "a.ply", folder / "b.c.compressed.ply")
        self.run_program("convert", folder / "a.ply", self.dir / "whole.sog")
        with zipfile.ZipFile(self.dir / "whole.sog") as archive:
            archive.extractall(folder / "sog")
        (folder / "d.ksplat").write_bytes(b"x")
        (folder / "broken.spz").write_bytes(b"x")
        (folder / "photo.jpg").write_bytes(b"x")
        made = ["a.spz", "b.c.spz", "sog.spz"]

        done = self.run_program("convert", folder, out, "--format", "spz", "--max-gaussians", 50, code=3)
        self.assertEqual(sorted(path.name for path in out.iterdir()), made)
        lines = done.stdout.splitlines()
        self.assertEqual([line.split()[1] for line in lines[:-1]], [str(out / name) for name in made])
        self.assertTrue(all("50 of 100 Gaussians" in line and "dB of 30 dB" in line for line in lines[:-1]), lines)
        self.assertEqual(lines[-1], "converted  3 of 5")
        errors = done.stderr.splitlines()
        self.assertEqual(len(errors), 3, errors)
        for line, name in zip(errors, [f"{folder}/broken.spz", f"{folder}/d.ksplat", "2 of 5 splats could not be converted"]):
            self.assertIn(name, line)

        (folder / "broken.spz").unlink()
        (folder / "d.ksplat").unlink()
        (out / "a.spz").unlink()
        again = self.run_program("convert", folder, out, "--format", "spz").stdout.splitlines()
        self.assertEqual([line.split()[0] for line in again], ["splat", "left", "left", "converted"])
        self.assertIn("1 of 3; 2 were there already", again[-1])

        self.error_of("convert", folder, out, code=2, names=["--format", ".spz"])
        self.error_of("convert", folder, out, "--format", "obj", code=2, names=["--format", ".spz"])
        self.error_of("convert", folder, out, "--format", "sog", "--crop", "cube", code=2, names=["--crop"])
        (self.dir / "empty").mkdir()
        self.error_of("convert", self.dir / "empty", out, "--format", "spz", code=3, names=["holds no splat"])

    def test_refuses_a_bomb(self):
        bomb = self.dir / "bomb.sog"
        with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("meta.json", "{}")
            archive.writestr("means_l.webp", bytes(64 << 20))
        self.error_of("export", bomb, "-o", self.dir / "b.ply", code=3, names=[bomb, "larger unpacked than packed"])

    def test_workspace_knows_its_cameras(self):
        out = self.dir / "run"
        small = ["--iterations", 5, "--max-gaussians", 600, "--set", "random-points=500", "--init", "random", "--proposers", "none"]
        self.run_program("train", self.scene, "-o", out, *small)
        whole = len(read_ply(out / "point_cloud.ply"))
        cropped = self.dir / "cropped.ply"
        said = self.run_program("export", out, "-o", cropped, "--crop", "auto", "--up", "auto", "--remove-outliers").stdout
        count = len(read_ply(cropped))
        self.assertIn(f"{count} of {whole} Gaussians", said)
        self.assertLessEqual(count, whole)
        self.assertGreater(count, whole / 2)


if __name__ == "__main__":
    main()

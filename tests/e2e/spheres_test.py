#!/usr/bin/env python3
"""Spherical photos (equirectangular): with poses, and photos that COLMAP places; fisheye photos of 190 degrees."""

import json
import math
import shutil
import struct
import subprocess
import unittest
import zlib

from harness import SMALL_RUN, EndToEnd, command, files_below, main, read_png, write_png

FACES = ["back", "down", "front", "left", "right", "up"]
XMP = b'<x:xmpmeta xmlns:GPano="http://ns.google.com/photos/1.0/panorama/" GPano:ProjectionType="equirectangular"/>'


def with_metadata(png):
    """A PNG that says of itself that it is a sphere, as a chunk behind the header that no decoder checks."""
    body = b"XML:com.adobe.xmp\0\0\0\0\0" + XMP
    chunk = struct.pack(">I", len(body)) + b"iTXt" + body + struct.pack(">I", zlib.crc32(b"iTXt" + body))
    end_of_header = 8 + 25
    return png[:end_of_header] + chunk + png[end_of_header:]


def center_of(frame):
    return [row[3] for row in frame["transform_matrix"][:3]]


def fisheye_of(sphere, side, focal, degrees):
    """What an equidistant lens sees of a spherical image, the nearest pixels of it: a circle before black."""
    width, height, _, pixels = sphere
    out = bytearray(3 * side * side)
    for y in range(side):
        for x in range(side):
            u, v = x + 0.5 - side / 2, y + 0.5 - side / 2
            angle = math.hypot(u, v) / focal
            if angle > math.radians(degrees) / 2:
                continue
            turn = math.atan2(v, u)
            right, down = math.sin(angle) * math.cos(turn), math.sin(angle) * math.sin(turn)
            column = int((math.atan2(right, math.cos(angle)) / (2 * math.pi) + 0.5) * width) % width
            row = min(int((math.asin(down) / math.pi + 0.5) * height), height - 1)
            at = 3 * (row * width + column)
            out[3 * (y * side + x) : 3 * (y * side + x) + 3] = pixels[at : at + 3]
    return write_png(side, side, 3, bytes(out))


def make_fisheye(scene, side, degrees=190):
    """Makes a scene of spheres one of fisheye photos, whose circles fill them."""
    focal = side / math.radians(degrees)
    transforms = json.loads((scene / "transforms.json").read_text())
    for frame in transforms["frames"]:
        path = scene / frame["file_path"]
        path.write_bytes(fisheye_of(read_png(path), side, focal, degrees))
    transforms.update(camera_model="OPENCV_FISHEYE", w=side, h=side, fl_x=focal, fl_y=focal, cx=side / 2, cy=side / 2)
    transforms["ply_file_path"] = "room.ply"
    (scene / "transforms.json").write_text(json.dumps(transforms))
    (scene / "room.ply").write_text(ply_of_room())


def ply_of_room(steps=18):
    """Points on the walls, the floor and the ceiling of the demo's room."""
    middle, half = (0, -0.7, 1.8), (3.6, 3.3, 1.8)
    points = []
    for axis in range(3):
        for side in (-1, 1):
            for i in range(steps):
                for k in range(steps):
                    place = [2 * (i + 0.5) / steps - 1, 2 * (k + 0.5) / steps - 1]
                    place.insert(axis, side)
                    points.append(" ".join(f"{middle[c] + half[c] * place[c]:.4f}" for c in range(3)))
    head = "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    return head.format(len(points)) + "\n".join(points) + "\n"


class Spheres(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.dir / "spheres"
        size = ["--kind", "spheres", "--demo-views", 4, "--width", 192, "--samples", 1]
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *size), check=True)

    def test_given_poses(self):
        scene, out = self.copy_scene("posed"), self.dir / "posed_out"
        (scene / "masks").mkdir()
        tripod = bytes(255 if y < 80 else 0 for y in range(96) for _ in range(192))
        (scene / "masks/000.png").write_bytes(write_png(192, 96, 1, tripod))
        before = files_below(scene)
        done = self.run_program("reconstruct", scene, "-o", out, *SMALL_RUN)
        self.assertIn("4 spherical photos are cut into 6 views each", done.stdout + done.stderr)
        self.assertEqual(files_below(scene), before, "input is never written to")
        split = json.loads((out / "split.json").read_text())
        self.assertEqual(split["test"], [f"images/000_{face}.png" for face in FACES], "a whole sphere is held out")
        self.assertEqual(len(split["train"]), 18)
        self.assertEqual(read_png(out / "faces/images/images/000_front.png")[:2], (73, 73))
        black = {face: read_png(out / f"faces/masks/images/000_{face}.png.png")[3].count(0) for face in FACES}
        self.assertEqual([face for face in FACES if black[face]], ["down"])
        self.assertGreater(json.loads((out / "metrics.json").read_text())["test"]["psnr"], 15)
        again = self.run_program("evaluate", out)
        self.assertNotIn("import", again.stdout)
        self.error_of("cameras", scene, "-o", self.dir / "cameras_out", code=3, names=["000.png", "oraclegs reconstruct"])
        info = json.loads(self.run_program("info", scene, "--json").stdout)
        self.assertEqual((info["views"], info["camera_models"]), (24, {"PINHOLE": 24}))

    def test_fisheye_beyond_half_a_sphere(self):
        scene, out = self.copy_scene("fisheye"), self.dir / "fisheye_out"
        make_fisheye(scene, 120)
        before = files_below(scene)
        from_points = [option if option != "random" else "sfm" for option in SMALL_RUN]
        done = self.run_program("reconstruct", scene, "-o", out, *from_points, "--set", "sfm-points=model")
        self.assertIn("4 fisheye photos are cut into 20 views", done.stdout + done.stderr)
        self.assertEqual(files_below(scene), before, "input is never written to")
        split = json.loads((out / "split.json").read_text())
        faces = ["down", "front", "left", "right", "up"]
        self.assertEqual(split["test"], [f"images/000_{face}.png" for face in faces], "a whole photo is held out")
        self.assertEqual(len(split["train"]), 15)
        for face in faces:
            width, height, _, pixels = read_png(out / f"faces/images/images/001_{face}.png")
            mask = read_png(out / f"faces/masks/images/001_{face}.png.png")[3]
            self.assertEqual(len(mask), width * height)
            self.assertFalse(any(mask[i] and not any(pixels[3 * i : 3 * i + 3]) for i in range(len(mask))), face)
            self.assertEqual(mask.count(0) == 0, face == "front")
        self.assertGreater(json.loads((out / "metrics.json").read_text())["test"]["psnr"], 15)
        self.error_of("cameras", scene, "-o", self.dir / "no_cameras", code=3, names=["000.png", "more than 160 degrees"])
        info = json.loads(self.run_program("info", scene, "--json").stdout)
        self.assertEqual((info["views"], info["masks"]), (20, 20))

    def test_a_panorama_is_no_sphere(self):
        scene = self.copy_scene("wide")
        (scene / "images/001.png").write_bytes(write_png(190, 96, 3, bytes(190 * 96 * 3)))
        self.error_of("reconstruct", scene, "-o", self.dir / "wide_out", code=3, names=["001.png", "190 x 96", "twice as wide"])


@unittest.skipUnless(shutil.which("colmap"), "needs colmap, which finds the poses")
class PhotosOfSpheres(EndToEnd):
    def test_poses_are_found_and_tied(self):
        scene, photos, out = self.dir / "large", self.dir / "photos", self.dir / "out"
        size = ["--kind", "spheres", "--demo-views", 16, "--width", 640, "--samples", 2]
        self.run_program("demo-scene", scene, "--quiet", *size)
        photos.mkdir()
        frames = json.loads((scene / "transforms.json").read_text())["frames"][:4]
        for frame in frames:
            png = scene / frame["file_path"]
            (photos / png.name).write_bytes(with_metadata(png.read_bytes()))
        self.run_program("sfm", photos, "-o", out)
        report = json.loads((out / "sfm/registration.json").read_text())
        self.assertEqual(report["registered"], 24)
        self.run_program("cameras", out, "-o", self.dir / "cameras")
        cameras = json.loads((self.dir / "cameras/transforms.json").read_text())["frames"]
        centers = {camera["file_path"].rsplit("/", 1)[-1].rsplit(".", 1)[0]: center_of(camera) for camera in cameras}
        for i in range(4):
            for face in FACES:
                apart = math.dist(centers[f"00{i}_{face}"], centers[f"00{i}_front"])
                self.assertLess(apart, 1e-4 * math.dist(centers["000_front"], centers["001_front"]), "one center")
        found, true = [centers[f"00{i}_front"] for i in range(4)], [center_of(frame) for frame in frames]
        scale = math.dist(found[0], found[3]) / math.dist(true[0], true[3])
        for i in range(4):
            for j in range(i):
                self.assertAlmostEqual(math.dist(found[i], found[j]) / scale / math.dist(true[i], true[j]), 1, delta=0.02)


if __name__ == "__main__":
    main()

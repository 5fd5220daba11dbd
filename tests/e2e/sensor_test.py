"""Depth of a sensor from the outside: a scene that names it, the usual mistakes, and captures of Polycam and Record3D."""

import json
import os
import shutil
import struct
import subprocess
import sys
import zipfile

from harness import ROOT, SMALL_RUN, EndToEnd, command, main, png, write_png

SCENE = ["--kind", "walls", "--sensor", "--demo-views", 8, "--width", 96, "--height", 72, "--samples", 1]
STEREO = ["--set", "stereo-iterations=2", "--set", "stereo-passes=1", "--refine-poses", "off", "--test-every", 4]
UNPACK = ROOT / "examples/record3d/unpack.py"


class Sensor(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.dir / "sensed"
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *SCENE), check=True)

    def depth(self, scene, *options, name=None):
        out = self.dir / (name or f"out_{scene.name}")
        done = self.run_program("depth", scene, "-o", out, "--overwrite", *STEREO, *options)
        record = json.loads((out / "stages.json").read_text())["depth"]
        return done.stdout + done.stderr, record

    def error_with(self, scene, *names, options=()):
        self.error_of("depth", scene, "-o", self.dir / "refused", *STEREO, *options, code=3, names=names)
        self.assertFalse((self.dir / "refused").exists())

    def test_a_run_takes_it_by_itself(self):
        done = self.run_program("reconstruct", self.scene, "-o", self.dir / "run", *SMALL_RUN, *STEREO[:-2], "--init", "dense", "--no-report")
        self.assertIn("depth of a sensor for 6 of 6 photos; scale 1", done.stdout + done.stderr)
        self.assertIn("sensor depth     8", self.run_program("info", self.scene).stdout)
        _, with_sensor = self.depth(self.scene)
        _, alone = self.depth(self.scene, "--depth-prior", "stereo", name="alone")
        self.assertEqual((with_sensor["prior"], alone["prior"]), ("sensor", "stereo"))
        self.assertGreater(with_sensor["confident_share"], alone["confident_share"] + 0.1)

    def test_bad_files_are_named_with_a_way_out(self):
        fix = "--depth-prior stereo"
        scene = self.copy_scene("bad")
        file, confidence = scene / "sensor/003.png", scene / "sensor_confidence/003.png"
        whole = file.read_bytes()
        file.write_bytes(png(48, 36, (9, 9, 9)))
        self.error_with(scene, file, "16 bits", fix)
        file.write_bytes(b"no picture")
        self.error_with(scene, file, "16 bits", fix)
        file.write_bytes(whole)
        confidence.write_bytes(write_png(36, 48, 1, bytes(36 * 48)))
        self.error_with(scene, confidence, "36 x 48", fix)
        shutil.copy(self.scene / "sensor_confidence/003.png", confidence)
        file.write_bytes(whole[: len(whole) // 2])
        self.error_of("depth", scene, "-o", self.dir / "cut", *STEREO, code=3, names=[file])
        self.depth(scene, "--depth-prior", "stereo")
        self.edit_transforms(scene, lambda t: t.update(depth_unit_scale_factor=-1))
        self.error_with(scene, "transforms.json", "depth_unit_scale_factor", "0.001")

    def test_without_any_there_is_nothing_to_take(self):
        scene = self.copy_scene("without")
        self.edit_transforms(scene, lambda t: [frame.pop("depth_file_path") for frame in t["frames"]])
        self.error_with(scene, "--depth-prior sensor", "depth_file_path", options=["--depth-prior", "sensor"])
        self.assertEqual(self.depth(scene)[1]["prior"], "stereo")

    def test_depth_for_less_than_half_waits_to_be_asked_for(self):
        scene = self.copy_scene("some")
        for i in range(5):
            (scene / f"sensor/{i:03}.png").unlink()
        said, record = self.depth(scene)
        self.assertIn("5 files of depth or its confidence do not exist", said)
        self.assertIn("3 of 8 photos have a depth of a sensor, which is not used", said)
        self.assertEqual(record["prior"], "stereo")
        said, record = self.depth(scene, "--depth-prior", "sensor", name="asked")
        self.assertIn("depth of a sensor for 3 of 6 photos", said)
        self.assertEqual(record["sensor"]["views"], 3)

    def polycam(self):
        """The scene as Polycam's raw export."""
        root = self.dir / "polycam/keyframes"
        transforms = json.loads((self.scene / "transforms.json").read_text())
        for folder, source in {"images": "images", "depth": "sensor", "confidence": "sensor_confidence"}.items():
            shutil.copytree(self.scene / source, root / folder)
        (root / "cameras").mkdir()
        for frame in transforms["frames"]:
            m = frame["transform_matrix"]
            camera = {f"t_{r}{c}": m[r][c] for r in range(3) for c in range(4)}
            camera |= {"fx": transforms["fl_x"], "fy": transforms["fl_y"], "cx": transforms["cx"], "cy": transforms["cy"],
                       "width": transforms["w"], "height": transforms["h"]}  # fmt: skip
            (root / f"cameras/{frame['file_path'][7:10]}.json").write_text(json.dumps(camera))
        return root.parent

    def test_polycams_export_brings_it(self):
        said, record = self.depth(self.polycam())
        self.assertIn("depth of a sensor for 6 of 6 photos", said)
        self.assertAlmostEqual(record["sensor"]["scale"], 1, delta=0.02)

    def record3d(self):
        """A capture of Record3D whose files are packed by nothing, and a package that unpacks that."""
        transforms = json.loads((self.scene / "transforms.json").read_text())
        poses, capture = [], self.dir / "capture.r3d"
        with zipfile.ZipFile(capture, "w") as archive:
            for i, frame in enumerate(transforms["frames"]):
                m = frame["transform_matrix"]
                w = (1 + m[0][0] + m[1][1] + m[2][2]) ** 0.5 / 2  # the cameras look forward: far from 0
                q = [(m[2][1] - m[1][2]) / (4 * w), (m[0][2] - m[2][0]) / (4 * w), (m[1][0] - m[0][1]) / (4 * w), w]
                poses.append(q + [m[r][3] for r in range(3)])
                archive.write(self.scene / frame["file_path"], f"rgbd/{i}.jpg")
                archive.writestr(f"rgbd/{i}.depth", struct.pack("<12f", *[2 + 0.1 * k for k in range(11)], float("nan")))
                archive.writestr(f"rgbd/{i}.conf", bytes([0, 1, 2] * 4))
            k = [transforms["fl_x"], 0, 0, 0, transforms["fl_y"], 0, transforms["cx"], transforms["cy"], 1]
            archive.writestr("metadata", json.dumps({"K": k, "w": 96, "h": 72, "dw": 4, "dh": 3, "fps": 60, "poses": poses}))
        package = self.dir / "package"
        package.mkdir()
        (package / "liblzfse.py").write_text("def decompress(data):\n    return data\n")
        return capture, {**os.environ, "PYTHONPATH": str(package)}

    def test_captures_of_record3d(self):
        capture, environment = self.record3d()
        folder, scene = self.dir / "capture", self.dir / "unpacked"
        with zipfile.ZipFile(capture) as archive:
            archive.extractall(folder)
        done = self.run_program("info", folder)
        self.assertIn("a capture of Record3D", done.stdout)
        self.assertIn("examples/record3d", done.stdout + done.stderr)
        subprocess.run([sys.executable, UNPACK, capture, scene, "2"], env=environment, check=True, capture_output=True)
        self.assertIn("sensor depth     4", self.run_program("info", scene).stdout)
        frame = json.loads((scene / "transforms.json").read_text())["frames"][1]
        truth = json.loads((self.scene / "transforms.json").read_text())["frames"][2]
        for row, true_row in zip(frame["transform_matrix"], truth["transform_matrix"]):
            for value, true_value in zip(row, true_row):
                self.assertAlmostEqual(value, true_value, places=6)
        self.run_program("depth", scene, "-o", self.dir / "out_unpacked", *STEREO)


if __name__ == "__main__":
    main()

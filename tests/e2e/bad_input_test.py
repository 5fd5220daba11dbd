#!/usr/bin/env python3
"""Every way in which input can be bad ends in one line that names the file and the mend, and in nothing half-written."""

import json
import os
import resource
import shutil
import signal
import struct

from harness import SMALL_RUN, EndToEnd, main, png


class BadInput(EndToEnd):
    def refused(self, scene, *arguments, code=3, names=(), **options):
        """reconstruct must refuse the scene and leave no result."""
        out = self.dir / "out_of_bad_input"
        shutil.rmtree(out, ignore_errors=True)
        line = self.error_of("reconstruct", scene, "-o", out, *SMALL_RUN, *arguments, code=code, names=names, **options)
        for name in ["point_cloud.ply", "metrics.json"]:
            self.assertFalse((out / name).exists())
        return line

    def first_image(self, scene):
        return sorted((scene / "images").glob("*.png"))[1]  # the first is a test view, this one trains

    def test_missing_folder(self):
        self.refused(self.dir / "nowhere", names=["nowhere"])

    def test_no_images(self):
        empty = self.dir / "empty"
        empty.mkdir()
        self.refused(empty, names=["empty"])
        (empty / "notes.txt").write_text("no photographs here")
        self.refused(empty, names=["empty"])

    def test_too_few_training_views(self):
        names = [p.stem for p in sorted((self.scene / "images").glob("*.png"))]
        self.refused(self.scene, "--test-views", ",".join(names), names=["training"])
        self.refused(self.scene, "--test-views", ",".join(names[1:]), names=["training"])
        self.refused(self.scene, "--test-views", "nobody", names=["nobody"])

    def test_a_device_that_is_not_there(self):
        self.refused(self.scene, "--device", "cuda:99", code=2, names=["--device cuda:99"])
        self.refused(self.scene, "--device", "gpu", code=2, names=["auto, cpu, cuda"])

    def test_more_views_than_exist(self):
        self.refused(self.scene, "--views", 100, names=["100"])

    def test_corrupt_photographs(self):
        scene = self.copy_scene("truncated_png")
        image = self.first_image(scene)
        image.write_bytes(image.read_bytes()[: image.stat().st_size // 2])
        self.refused(scene, names=[image.name])

        scene = self.copy_scene("corrupt_jpeg")
        image = self.first_image(scene)
        image.write_bytes(b"\xff\xd8\xff\xe0\x00\x10JFIF\x00\x01 and then nothing of the kind")
        self.refused(scene, names=[image.name])

        scene = self.copy_scene("no_picture")
        image = self.first_image(scene)
        image.write_bytes(b"")
        self.refused(scene, names=[image.name])

    def test_a_corrupt_test_photograph_is_found_before_training(self):
        scene = self.copy_scene("truncated_test_view")
        image = sorted((scene / "images").glob("*.png"))[0]
        image.write_bytes(image.read_bytes()[:-200])
        self.refused(scene, names=[image.name])

    def test_size_that_disagrees(self):
        scene = self.copy_scene("other_size")
        image = self.first_image(scene)
        image.write_bytes(png(50, 40, (200, 100, 50)))
        self.refused(scene, names=[image.name, "50"])

    def test_impossible_poses_and_lenses(self):
        def pose(value):
            def edit(transforms):
                transforms["frames"][1]["transform_matrix"][0][0] = value

            return edit

        def focal(transforms):
            for where in [transforms, *transforms["frames"]]:
                for key in {"fl_x", "fl_y"} & set(where):
                    where[key] = 0
                for key in {"camera_angle_x", "camera_angle_y"} & set(where):
                    del where[key]

        for name, edit in [("nan_pose", pose(float("nan"))), ("huge_pose", pose(1e300)), ("no_rotation", pose(3.0)),
                           ("zero_focal", focal)]:  # fmt: skip
            scene = self.copy_scene(name)
            self.edit_transforms(scene, edit)
            with self.subTest(name):
                self.refused(scene, names=["transforms.json"])

    def test_broken_transforms(self):
        scene = self.copy_scene("broken_json")
        path = scene / "transforms.json"
        path.write_text(path.read_text()[:300])
        self.refused(scene, names=["transforms.json"])

    def test_truncated_colmap_model(self):
        scene = self.dir / "colmap_scene"
        model = scene / "sparse" / "0"
        model.mkdir(parents=True)
        (scene / "images").mkdir()
        for i in range(4):
            (scene / "images" / f"{i}.png").write_bytes(png(40, 30, (60 * i, 90, 120)))
        camera = struct.pack("<QiiQQ4d", 1, 1, 1, 40, 30, 35.0, 35.0, 20.0, 15.0)
        images = struct.pack("<Q", 4)
        for i in range(4):
            images += struct.pack("<i7di", i + 1, 1, 0, 0, 0, 0.1 * i, 0, 2, 1)
            images += f"{i}.png\0".encode() + struct.pack("<Q", 0)
        files = {"cameras.bin": camera, "images.bin": images, "points3D.bin": struct.pack("<Q", 0)}

        def write(**changed):
            for name, data in files.items():
                (model / name).write_bytes(changed.get(name.split(".")[0], data))

        for name, data in files.items():
            write(**{name.split(".")[0]: data[:-3]})
            with self.subTest(f"truncated {name}"):
                self.refused(scene, names=[name])
        write(cameras=camera[:-32] + struct.pack("<4d", 0, 0, 20, 15))
        self.refused(scene, names=["cameras.bin"])
        write(images=struct.pack("<Q", 1 << 60) + images[8:])  # a count that no file can hold
        self.refused(scene, names=["images.bin"])

    def test_photographs_that_do_not_register(self):
        scene = self.dir / "blank"
        scene.mkdir()
        for i in range(3):
            (scene / f"{i}.png").write_bytes(png(64, 48, (90 * i, 120, 30)))
        self.refused(scene, names=["blank"])

    def test_scenes_without_depth_are_trained_all_the_same(self):
        def one_pose(transforms):
            for frame in transforms["frames"]:
                frame["transform_matrix"] = transforms["frames"][0]["transform_matrix"]

        same, blank = self.copy_scene("one_pose"), self.copy_scene("no_texture")
        self.edit_transforms(same, one_pose)
        for image in (blank / "images").glob("*.png"):
            width, height = struct.unpack(">II", image.read_bytes()[16:24])
            image.write_bytes(png(width, height, (120, 120, 120)))
        small = ["--iterations", 20, "--max-gaussians", 500, "--set", "stereo-iterations=2", "--set", "stereo-passes=1"]
        for scene, words in [(same, "have one and the same pose"), (blank, "or they have no texture")]:
            with self.subTest(scene.name):
                out = self.dir / f"trained_{scene.name}"
                done = self.run_program("reconstruct", scene, "-o", out, "--test-every", 4, *small)
                for told in [words, "no views are proposed", "starting from random points"]:
                    self.assertIn(told, done.stderr)
                self.assertNotIn("_start", done.stderr, "the stack of a crash in colmap")
                self.assertTrue((out / "point_cloud.ply").exists())

    def test_output_that_is_no_place_to_write(self):
        self.error_of("reconstruct", self.scene, "-o", self.scene, code=3, names=[self.scene, "-o"])
        self.error_of("reconstruct", self.scene, "-o", self.scene / "out", code=3, names=["out", "-o"])
        file = self.dir / "a_file"
        file.write_text("x")
        self.error_of("reconstruct", self.scene, "-o", file, code=4, names=["a_file"])
        self.error_of("reconstruct", self.scene, "-o", file / "out", code=4, names=["a_file"])
        self.error_of("reconstruct", self.scene, "-o", "/proc/oraclegs", code=4, names=["/proc/oraclegs"])
        self.error_of("demo-scene", file / "demo", code=4, names=["a_file"])
        theirs = self.dir / "theirs"
        theirs.mkdir()
        (theirs / "thesis.tex").write_text("precious")
        self.error_of("reconstruct", self.scene, "-o", theirs, "--overwrite", code=3, names=["theirs", "-o"])
        self.assertEqual(os.listdir(theirs), ["thesis.tex"])

    def test_output_that_holds_another_run(self):
        out = self.dir / "first_run"
        run = ["-o", out, *SMALL_RUN, "--iterations", 5]
        self.run_program("train", self.scene, *run)
        before = (out / "point_cloud.ply").read_bytes()
        self.error_of("reconstruct", self.scene, *run, "--downscale", 2, code=3,
                      names=[out, "--downscale was auto, now is 2", "--overwrite"])  # fmt: skip
        other = self.copy_scene("another_scene")
        self.error_of("reconstruct", other, *run, code=3, names=[out, other])
        self.assertEqual((out / "point_cloud.ply").read_bytes(), before)

    def test_disk_full(self):
        # A limit on the size of files stands in for a full disk: it needs no rights, and write() fails likewise.
        out = self.dir / "full"

        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

        arguments = ["reconstruct", self.scene, "-o", out, *SMALL_RUN, "--iterations", 5, "--depth-weight", 0]
        self.error_of(*arguments, code=4, names=["point_cloud.ply"], preexec_fn=limit, restore_signals=False)
        self.assertFalse((out / "point_cloud.ply").exists())
        self.assertEqual([name for name in os.listdir(out) if name.endswith(".tmp")], [])
        self.run_program(*arguments)  # with room again, the same command succeeds
        self.assertEqual(json.loads((out / "metrics.json").read_text())["train"]["iterations"], 5)

    def test_damaged_workspace_files_are_named(self):
        out = self.dir / "damaged"
        self.run_program("train", self.scene, "-o", out, *SMALL_RUN, "--iterations", 5)
        ply = out / "point_cloud.ply"
        ply.write_bytes(ply.read_bytes()[:-10])
        self.error_of("evaluate", out, code=3, names=[ply])
        self.error_of("export", ply, "-o", self.dir / "x.ply", code=3, names=[ply])
        self.error_of("info", ply, code=3, names=[ply])
        (out / "options.json").write_text("{")
        self.error_of("evaluate", out, code=3, names=["options.json"])


if __name__ == "__main__":
    main()

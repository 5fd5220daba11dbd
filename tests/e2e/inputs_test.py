"""What people bring: several photos, HEIC, a video, a zip, folders in folders, strange names."""

import json
import os
import shutil
import subprocess
import unittest
import zipfile

from harness import EndToEnd, files_below



def ffmpeg(*arguments):
    subprocess.run(["ffmpeg", "-v", "error", "-y", *map(str, arguments)], check=True)


class Inputs(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.photos = sorted(p for p in cls.scene.rglob("*.png") if p.parent.name == "images")[:4]
        cls.no_colmap = cls.dir / "no_colmap"
        cls.no_colmap.mkdir()
        (cls.no_colmap / "colmap").write_text("#!/bin/sh\nexit 1\n")
        (cls.no_colmap / "colmap").chmod(0o755)
        cls.jpegs = cls.dir / "jpegs"
        cls.jpegs.mkdir()
        for photo in cls.photos:
            ffmpeg("-i", photo, "-vf", "scale=384:-2", "-q:v", 2, cls.jpegs / f"{photo.stem}.jpg")

    def sfm(self, *inputs, out):
        """Up to colmap, which takes minutes with images of so little texture: here it ends at once."""
        environment = {**os.environ, "PATH": f"{self.no_colmap}:{os.environ['PATH']}"}
        return self.run_program("sfm", *inputs, "-o", self.dir / out, code=4, env=environment)

    def imported(self, out):
        return sorted(p for p in files_below(self.dir / out / "photos/images"))

    def test_strange_names_and_no_second_import(self):
        folder = self.dir / "strange"
        folder.mkdir()
        names = ["with space.jpg", "quote'\".jpg", "line\nbreak.jpg", "ümlaut.jpg"]
        for name, jpeg in zip(names, sorted(self.jpegs.iterdir())):
            shutil.copy(jpeg, folder / name)
        before = files_below(folder)
        self.sfm(*(folder / name for name in names), out="strange_out")
        self.assertEqual(self.imported("strange_out"), sorted(["with space.jpg", "quote'\".jpg", "line?break.jpg", "ümlaut.jpg"]))
        first = files_below(self.dir / "strange_out" / "photos")
        self.sfm(*(folder / name for name in names), out="strange_out")
        self.assertEqual(files_below(self.dir / "strange_out" / "photos"), first)
        self.assertEqual(files_below(folder), before)
        saved = json.loads((self.dir / "strange_out" / "options.json").read_text())
        self.assertEqual(len(saved["inputs"]), 4)
        self.error_of("sfm", folder / names[0], folder / names[1], "-o", self.dir / "strange_out", code=3,
                      names=["holds a run of another scene", "--overwrite"])  # fmt: skip

    def test_a_zip_and_heic(self):
        archive = self.dir / "photos.zip"
        with zipfile.ZipFile(archive, "w") as file:
            for jpeg in sorted(self.jpegs.iterdir()):
                heic = self.dir / f"{jpeg.stem}.heic"
                subprocess.run(["heif-enc", "-q", "90", "-o", heic, jpeg], check=True, capture_output=True)
                file.write(heic, f"trip/{heic.name}")
            file.writestr("trip/raw.CR2", "x")
            file.writestr("../evil.txt", "x")
        done = self.sfm(archive, out="zip_out")
        self.assertIn("trip/raw.CR2: raw photos are not read; export them as JPEG", done.stderr)
        self.assertEqual(self.imported("zip_out"), [f"trip/{p.stem}.heic" for p in sorted(self.jpegs.iterdir())])
        self.assertTrue(list((self.dir / "zip_out" / "sfm" / "images").rglob("*.heic.jpg")), "colmap gets JPEGs")

    def test_a_video(self):
        video = self.dir / "my clip.mp4"
        ffmpeg("-f", "lavfi", "-i", "testsrc2=size=320x240:rate=10:duration=3", "-c:v", "mpeg4", "-q:v", 3, video)
        self.sfm(video, "--frames", 6, out="video_out")
        self.assertEqual(self.imported("video_out"), [f"frame_{i:04}.jpg" for i in range(1, 7)])

    def test_bad_inputs_are_named(self):
        out = self.dir / "bad_out"
        text, empty, fake, cut = (self.dir / n for n in ("notes.txt", "empty.mp4", "fake.mp4", "cut.zip"))
        text.write_text("text")
        empty.touch()
        fake.write_text("no video")
        cut.write_bytes(b"PK\3\4 and no more")
        for path, what in [(text, "is neither a photo, a video"), (empty, "is empty"), (fake, "holds no video"),
                           (cut, "is a damaged or incomplete zip")]:  # fmt: skip
            self.error_of("sfm", path, "-o", out, code=3, names=[path, what])
        self.error_of("sfm", self.dir / "nowhere.jpg", text, "-o", out, code=3, names=["nowhere.jpg", "no such file"])
        self.error_of("sfm", self.jpegs, text, "-o", self.jpegs / "out", code=3, names=["notes.txt"])
        self.error_of("sfm", self.jpegs, self.jpegs, "-o", self.jpegs / "out", code=3, names=["lies in the scene folder"])
        self.error_of("ablate", self.jpegs, self.jpegs, "-o", out, code=2, names=["takes one scene folder"])
        self.assertFalse(out.exists(), "nothing is written for what cannot be read")

    def test_a_folder_in_brackets(self):
        folder = self.dir / "[2024]"
        shutil.copytree(self.jpegs, folder)
        environment = {**os.environ, "PATH": f"{self.no_colmap}:{os.environ['PATH']}"}
        self.run_program("sfm", folder.name, "-o", self.dir / "bracket_out", code=4, cwd=self.dir, env=environment)
        saved = json.loads((self.dir / "bracket_out" / "options.json").read_text())
        self.assertEqual(saved["scene"], str(folder.resolve()))

    def test_photos_in_the_workspace_are_not_lost(self):
        out = self.dir / "own_out"
        shutil.copytree(self.jpegs, out / "photos")
        before = files_below(out)
        self.error_of("sfm", *sorted((out / "photos").iterdir()), "-o", out, "--overwrite", code=3, names=["lies in the workspace"])
        self.assertEqual(files_below(out), before)

    def test_folders_in_folders_and_what_is_skipped(self):
        folder = self.dir / "deep"
        (folder / "left" / "more").mkdir(parents=True)
        for i, jpeg in enumerate(sorted(self.jpegs.iterdir())):
            shutil.copy(jpeg, folder / ("left/more" if i % 2 else "left") / jpeg.name)
        (folder / "IMG_1.CR2").write_text("x")
        (folder / "clip.mov").write_text("x")
        (folder / "broken.jpg").write_text("x")
        done = self.sfm(folder, out="deep_out")
        for words in ("IMG_1.CR2: raw photos are not read", "clip.mov: videos beside photos", "broken.jpg"):
            self.assertIn(words, done.stderr)
        self.assertFalse((self.dir / "deep_out" / "photos").exists(), "one folder is used where it is")


if __name__ == "__main__":
    unittest.main()

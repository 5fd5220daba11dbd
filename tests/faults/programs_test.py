#!/usr/bin/env python3
"""colmap, ffmpeg and generators that are missing, fail, hang, are killed or write rubbish: one line, or a recovery."""

import os
import shutil
import signal
import subprocess
import time
import unittest

from lab import Lab, error_of, results, some

FAULTS = ["fail", "crash", "killed", "full", "memory", "nothing", "rubbish", "hang"]
STALL = {"ORACLEGS_STALL_LIMIT": "0.4"}


class Programs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = Lab()
        cls.addClassCleanup(cls.lab.close)
        cls.finished = cls.lab.dir / "reference"
        cls.lab.finish(cls.finished)
        cls.reference = results(cls.finished)

    def setUp(self):
        self.out = self.lab.dir / "out"
        shutil.rmtree(self.out, ignore_errors=True)

    def tearDown(self):
        self.lab.check_no_orphans()
        self.lab.check_surroundings()

    def run_with(self, *more, **environment):
        code, text = self.lab.start(self.out, *more, environment=environment).wait()
        self.assertNotIn("internal error", text)
        self.lab.check_records(self.out)
        return code, text

    def check_mended(self):
        """The same command with programs that work."""
        self.lab.finish(self.out)
        self.lab.check_finished(self.out, self.reference)

    def fails(self, fault, command, *words, code=4):
        done, text = self.run_with(FAKE_COLMAP_FAULT=f"{command}:{fault}", **STALL)
        self.assertEqual(done, code, text)
        line = error_of(text)
        for word in words:
            self.assertIn(word, line)
        return line

    def test_colmap_that_goes_wrong_in_registration(self):
        words = {"fail": ["ended with code 1", "it does not work out"], "crash": ["crashed (signal 11)"],
                 "killed": ["killed from outside"], "full": ["make room"], "memory": ["ran out of memory"],
                 "nothing": ["was not written by colmap"], "rubbish": ["features0.db: file is not a database"],
                 "hang": ["did nothing for 0.4 s"]}  # fmt: skip
        for fault in some(FAULTS, 4):
            with self.subTest(fault):
                self.fails(fault, "feature_extractor", str(self.out), *words[fault])
        self.check_mended()

    def test_a_mapper_that_goes_wrong(self):
        for fault in some(["hang", "killed", "full", "memory"], 2):
            with self.subTest(fault):
                self.fails(fault, "mapper", "colmap mapper")
        self.fails("crash", "mapper", "colmap mapper crashed (signal 11)", "run the same command again")
        for fault in some(["fail", "nothing"], 1):  # as where nothing registers
            with self.subTest(fault):
                self.fails(fault, "mapper", "could not be found", code=3)
        shutil.rmtree(self.out / "sfm")  # what nothing registered in is not tried again
        self.fails("rubbish", "mapper", ".db: file is not a database")

    def test_a_triangulation_that_goes_wrong(self):
        for fault in some(["hang", "killed", "full", "memory"], 2):
            with self.subTest(fault):
                self.fails(fault, "point_triangulator", "colmap point_triangulator", "training_views")
        self.check_mended()

    def test_a_triangulation_that_always_fails_is_not_tried_again(self):
        code, text = self.run_with(FAKE_COLMAP_FAULT="point_triangulator:crash")
        self.assertEqual(code, 0, text)
        self.assertIn("no points are triangulated", text)
        log = (self.out / "sfm/training_views/colmap.log").read_bytes()
        code, text = self.run_with(FAKE_COLMAP_FAULT="point_triangulator:crash")
        self.assertEqual(code, 0, text)
        self.assertEqual((self.out / "sfm/training_views/colmap.log").read_bytes(), log)

    def test_rubbish_of_the_triangulation_is_named(self):
        code, text = self.run_with(FAKE_COLMAP_FAULT="point_triangulator:rubbish")
        self.assertIn(code, (3, 4), text)
        self.assertIn("training_views", error_of(text))
        self.check_mended()

    def test_without_colmap(self):
        folders = self.lab.dir / "no_colmap"
        folders.mkdir(exist_ok=True)
        code, text = self.run_with(PATH=str(folders))
        self.assertEqual(code, 3, text)
        self.assertIn("apt install colmap", error_of(text))
        (folders / "colmap").write_text("not executable")
        code, text = self.run_with(PATH=str(folders))
        self.assertEqual(code, 3, text)
        (folders / "colmap").write_bytes(b"\x7fELF rubbish")
        (folders / "colmap").chmod(0o755)
        code, text = self.run_with(PATH=str(folders))
        self.assertEqual(code, 4, text)
        self.assertIn("colmap", error_of(text))
        self.check_mended()

    def test_ffmpeg_that_goes_wrong_costs_the_video_alone(self):
        faults = [("hangs", "sleep 60", "did nothing"), ("killed", "kill -KILL $$", "ffmpeg failed"),
                  ("rubbish", "cat > /dev/null; printf '\\033[31m\\a\\0' >&2; exit 1", "no video"),
                  ("fails", "exit 3", "ffmpeg failed"), ("ends early", "head -c 10; exit 0", "video"),
                  ("is deaf", "trap '' TERM; while :; do sleep 1; done", "did nothing")]  # fmt: skip
        for name, body, words in some(faults, 2):
            with self.subTest(name):
                self.lab.fake("ffmpeg", body)
                shutil.rmtree(self.out, ignore_errors=True)
                shutil.copytree(self.finished, self.out, symlinks=True)
                shutil.rmtree(self.out / "renders/orbit")
                (self.out / "report/run.json").unlink()
                code, text = self.run_with(**STALL)
                self.assertEqual(code, 0, text)
                self.assertIn(words, text)
                self.assertFalse(any(ord(c) < 32 and c != "\n" for c in text), repr(text))
                self.assertEqual(list(self.out.rglob("*.tmp")), [])
        (self.lab.programs / "ffmpeg").unlink()

    def test_ffmpeg_that_goes_wrong_with_a_video_as_input(self):
        video = self.lab.dir / "walk.mp4"
        subprocess.run(["ffmpeg", "-loglevel", "error", "-f", "lavfi", "-i", "testsrc2=s=96x72:r=10:d=2", "-y", video],
                       check=True)  # fmt: skip
        before = video.read_bytes()
        faults = [
            ("hangs", "sleep 60", 4, "walk.mp4: ffmpeg did nothing for 0.4 s"),
            ("killed", "kill -KILL $$", 4, "walk.mp4: ffmpeg was killed from outside"),
            ("full", "echo 'No space left on device' >&2; exit 1", 4, "make room there"),
            ("fails", "echo it broke >&2; exit 3", 3, "walk.mp4: holds no video that ffmpeg can read (it broke)"),
            ("nothing", "exit 0", 3, "walk.mp4: holds no video"),
        ]
        for name, body, code, words in faults:
            with self.subTest(name):
                self.lab.fake("ffmpeg", body)
                run = self.lab.start(self.out, source=video, environment=STALL)
                done, text = run.wait()
                self.assertEqual(done, code, text)
                self.assertIn(words, error_of(text))
                self.assertEqual([path.name for path in self.out.rglob("*") if path.is_file()], ["options.json"])
        (self.lab.programs / "ffmpeg").unlink()
        self.assertEqual(video.read_bytes(), before)

    def test_a_generator_that_goes_wrong(self):
        faults = [("hangs", "sleep 60 & wait", "after 1 s"), ("fails", "exit 7", "exit code 7"),
                  ("killed", "kill -KILL $$", "exit code 137"), ("silent", "true", "generator"),
                  ("is deaf", "trap '' TERM INT; sleep 60 & wait; wait", "after 1 s")]  # fmt: skip
        for name, command, words in some(faults, 2):
            with self.subTest(name):
                code, text = self.run_with("--proposers", "command", "--generator", command, "--generator-timeout", 1)
                self.assertIn(code, (3, 4), text)
                self.assertIn(words, error_of(text))
                self.lab.check_no_orphans()

    def test_a_second_run_waits_for_what_a_killed_one_left(self):
        run = self.lab.start(self.out, environment={"FAKE_COLMAP_FAULT": "feature_extractor:hang"})
        deadline = time.monotonic() + 20
        while len(self.lab.alive()) < 3 and time.monotonic() < deadline:
            time.sleep(0.01)
        run.process.send_signal(signal.SIGKILL)
        # The lock ends with the last of its programs, within moments: no second colmap beside the first.
        self.lab.finish(self.out)
        self.lab.check_finished(self.out, self.reference)
        run.wait()

    def test_an_ending_of_the_whole_name(self):
        """pkill -9 oraclegs also hits by name what looks after the programs."""
        run = self.lab.start(self.out, environment={"FAKE_COLMAP_FAULT": "feature_extractor:hang"})
        deadline = time.monotonic() + 20
        while len(self.lab.alive()) < 3 and time.monotonic() < deadline:
            time.sleep(0.01)
        for pid in self.lab.alive():
            with open(f"/proc/{pid}/comm", encoding="utf-8") as comm:
                if "oraclegs" in comm.read():
                    os.kill(pid, signal.SIGKILL)
        run.wait()
        self.lab.check_no_orphans()


if __name__ == "__main__":
    unittest.main(verbosity=2)

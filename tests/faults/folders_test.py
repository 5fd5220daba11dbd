#!/usr/bin/env python3
"""Folders that cannot be written, are removed or full, little memory, numbers that are none, damaged records."""

import errno
import json
import math
import random
import resource
import shutil
import struct
import unittest

from fill_disk import Disk
from lab import STAGES, Lab, difference, error_of, results, some


class Folders(unittest.TestCase):
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

    def copy_finished(self, without=()):
        """The finished run, in which some stages are to be done again."""
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.copytree(self.finished, self.out, symlinks=True)
        path = self.out / "stages.json"
        records = json.loads(path.read_text())
        path.write_text(json.dumps({name: record for name, record in records.items() if name not in without}))

    def cut(self, pattern):
        """Files of the run that lack their end."""
        for file in self.out.glob(pattern):
            file.write_bytes(file.read_bytes()[: file.stat().st_size // 3])

    def check_mended(self):
        self.lab.finish(self.out)
        self.lab.check_finished(self.out, self.reference)

    def test_a_folder_that_is_removed_in_any_stage(self):
        for stage in some(STAGES, 3):
            with self.subTest(stage):
                self.copy_finished(STAGES[STAGES.index(stage) :])
                run = self.lab.start(self.out)
                self.assertTrue(run.wait_for(stage))
                while self.out.exists():  # the run may make a folder meanwhile
                    shutil.rmtree(self.out, ignore_errors=True)
                code, text = run.wait()
                self.assertIn(code, (3, 4), text)
                self.assertIn(str(self.out), error_of(text))
                self.assertFalse((self.out / "point_cloud.ply").exists())
                shutil.rmtree(self.out, ignore_errors=True)
        self.check_mended()

    def test_a_folder_that_is_replaced(self):
        run = self.lab.start(self.out)
        self.assertTrue(run.wait_for("depth"))
        self.out.rename(self.lab.dir / "moved")
        self.out.mkdir()
        code, text = run.wait()
        self.assertEqual(code, 4, text)
        self.assertIn("was removed or replaced", error_of(text))
        self.assertEqual([path for path in self.out.rglob("*") if path.is_file()], [])
        shutil.rmtree(self.lab.dir / "moved")
        self.check_mended()

    def test_a_folder_that_cannot_be_written(self):
        """Root may write anywhere, so that the library says what a read-only file system would."""
        disk = Disk(self.lab, self.out)
        read_only = {"FULL_DISK_ERRNO": str(errno.EROFS), "FULL_DISK_NAMES": "1"}
        for prepare in [lambda: self.out.mkdir(exist_ok=True), self.copy_finished]:
            prepare()
            code, text = self.lab.start(self.out, environment={**disk.environment(0), **read_only}).wait()
            self.assertEqual(code, 4, text)
            self.assertIn("Read-only file system", error_of(text))
            self.assertIn(str(self.out), error_of(text))
        self.check_mended()

    def test_a_disk_that_fails_halfway(self):
        disk = Disk(self.lab, self.out)
        failing = {"FULL_DISK_ERRNO": str(errno.EIO), "FULL_DISK_LATE": "1"}
        code, text = self.lab.start(self.out, environment={**disk.environment(2_000_000), **failing}).wait()
        self.assertEqual(code, 4, text)
        self.assertIn("Input/output error", error_of(text))
        self.check_mended()

    def test_a_disk_that_is_full_for_the_live_page_alone(self):
        self.copy_finished(STAGES[STAGES.index("depth") :])
        full = {**Disk(self.lab, self.out / "live").environment(0), "FULL_DISK_NAMES": "1"}
        code, text = self.lab.start(self.out, environment=full).wait()
        self.assertEqual(code, 0, text)
        self.assertEqual(text.count("No space left on device"), 1, text)
        self.lab.check_finished(self.out, self.reference)

    def test_a_temporary_folder_that_is_full_is_not_needed(self):
        disk = Disk(self.lab, self.lab.temporary)
        full = {**disk.environment(0), "FULL_DISK_NAMES": "1"}
        self.lab.finish(self.out, environment=full)
        self.lab.check_finished(self.out, self.reference)
        self.copy_finished()
        self.lab.finish(self.out, environment={"TMPDIR": "/nonexistent/folder"})

    def test_little_memory(self):
        numbers, begins = random.Random(4), 100  # MB, which the libraries of the program have
        for stage in some(STAGES, 4):
            with self.subTest(stage):
                self.copy_finished(STAGES[STAGES.index(stage) :])
                limit = numbers.randrange(begins, 2 * begins) << 20
                run = self.lab.start(self.out, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
                code, text = run.wait()
                self.assertIn(code, (0, 4), f"{limit >> 20} MB: {text}")
                if code == 4:
                    self.assertIn("memory", error_of(text), f"{limit >> 20} MB")
                self.lab.check_records(self.out)
        self.check_mended()

    def test_records_of_other_types(self):
        edits = [("sfm", "points", "many"), ("train", "gaussians", []), ("depth", "files", 3), ("depth", "key", None),
                 ("evaluate", "test", []), ("report", "seconds", {}), ("validate", "seconds", "abc")]  # fmt: skip
        for stage, key, value in some(edits, 3):
            with self.subTest(f"{stage}.{key}"):
                self.copy_finished()
                path = self.out / "stages.json"
                records = json.loads(path.read_text())
                records[stage][key] = value
                path.write_text(json.dumps(records))
                self.check_mended()
        for text in some(["[" * 100_000, "[]", "3", "{\"sfm\":", "{\"sfm\": 3}", "\0" * 100, ""], 2):
            with self.subTest(text[:10]):
                self.copy_finished()
                (self.out / "stages.json").write_text(text)
                self.lab.finish(self.out)
                other = difference(results(self.out), self.reference)
                self.assertIn(other, ([], ["metrics.json"]))  # where training began is known from there alone

    def test_files_of_the_run_that_are_cut_heal(self):
        redone = STAGES[STAGES.index("validate") :]
        patterns = ["proposals/proxy_models/*.ply", "depth/001.png", "metrics.json", "depth/depth_params.json", "sfm/dense.ply",
                    "point_cloud.ply", "frame.json", "split.json", "depth/confidence/001.png", "report/run.json",
                    "sfm/training_views/sparse/0/points3D.txt", "live/state.json", "train.csv",
                    "confidence/coverage_0000.png", "confidence/transforms.json"]  # fmt: skip
        for pattern in some(patterns, 3):
            with self.subTest(pattern):
                self.copy_finished(["proxies", *redone] if "proxy_models" in pattern else redone)
                self.cut(pattern)
                self.check_mended()
        files = ["confidence/transforms.json", "proposals/coverage_0000.png", "confidence/coverage_0000.png"]
        for pattern in some(files, 2):
            with self.subTest(f"before training: {pattern}"):
                self.copy_finished(["train", "evaluate", "report"])
                self.cut(pattern)
                self.check_mended()

    def test_a_report_of_files_that_are_cut(self):
        patterns = ["point_cloud.ply", "confidence/*.png", "metrics.json", "proposals/*.png", "confidence/transforms.json",
                    "depth/*.png", "renders/test/*.png", "report/run.json", "oracle.json"]  # fmt: skip
        for pattern in some(patterns, 3):
            with self.subTest(pattern):
                self.copy_finished(["report"])
                self.cut(pattern)
                code, text = self.lab.start(self.out).wait()
                self.assertNotIn("internal error", text)
                self.assertEqual(code, 0, text)

    def test_a_damaged_checkpoint_gives_way_to_the_one_before(self):
        run = self.lab.start(self.out, "--iterations", 3000)
        folder = self.out / "checkpoints"
        while not folder.exists() or len(list(folder.glob("*.safetensors"))) < 2:
            self.assertIsNone(run.process.poll())
        run.process.kill()
        run.wait()
        saved = sorted(folder.glob("*.safetensors"))
        data = bytearray(saved[-1].read_bytes())
        data[len(data) // 2] ^= 1
        saved[-1].write_bytes(data)
        text = self.lab.finish(self.out, "--iterations", 3000)
        self.assertIn("checksum mismatch", text)
        self.assertIn(saved[-2].name, text)

    def test_numbers_that_are_none(self):
        """A NaN in what a run reads ends in one line, not in a splat of NaN."""
        for value in some([math.nan, math.inf, -1e30], 1):
            with self.subTest(value):
                self.copy_finished(["train", "evaluate", "report"])
                path = self.out / "sfm/dense.ply"
                data = bytearray(path.read_bytes())
                at = data.index(b"end_header\n") + len(b"end_header\n")
                data[at : at + 4] = struct.pack("<f", value)
                path.write_bytes(data)
                code, text = self.lab.start(self.out).wait()
                self.assertNotIn("internal error", text)
                self.assertIn(code, (0, 3, 4), text)
                if code == 0:
                    self.assertEqual(results(self.out), self.reference)
        splat = self.lab.dir / "nan.ply"
        data = bytearray((self.finished / "point_cloud.ply").read_bytes())
        at = data.index(b"end_header\n") + len(b"end_header\n")
        data[at : at + 4] = struct.pack("<f", math.nan)
        splat.write_bytes(data)
        code, text = self.lab.start(self.lab.dir / "nan.spz", command="export", source=splat).wait()
        self.assertNotEqual(code, 0, text)
        splat.unlink()


if __name__ == "__main__":
    unittest.main(verbosity=2)

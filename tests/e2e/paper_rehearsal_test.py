"""The rehearsal of the paper's presets: in small from end to end, and the parts of the large one that need no GPU."""

import os
import re
import struct
import subprocess
import sys
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

from harness import PROGRAM, ROOT, EndToEnd, main, png, read_png

sys.path.insert(0, str(ROOT / "scripts"))
import paper_rehearsal  # noqa: E402
import stand_ins  # noqa: E402

STAGES = {"sfm", "depth", "propose", "validate", "start", "train", "evaluate"}
NO_GPU = "#!/bin/sh\nexit 9\n"
GPU = "#!/bin/sh\n[ $# -gt 3 ] || exec echo '300, Some GPU'\necho 1324\nsleep 5\n"  # asked once, then again and again


class PaperRehearsal(EndToEnd):
    def path_with(self, smi):
        """$PATH where nvidia-smi is this script."""
        folder = self.dir / f"bin_{len(smi)}"
        folder.mkdir(exist_ok=True)
        (folder / "nvidia-smi").write_text(smi)
        (folder / "nvidia-smi").chmod(0o755)
        return f"{folder}:{os.environ['PATH']}"

    def test_in_small(self):
        tiny = os.environ.get("ORACLEGS_TINY_NETWORKS", str(Path(PROGRAM).with_name("tiny_networks")))
        env = os.environ | {"ORACLEGS_BIN": PROGRAM, "ORACLEGS_TINY_NETWORKS": tiny, "PATH": self.path_with(NO_GPU)}
        script = ROOT / "scripts/paper_rehearsal.sh"
        done = subprocess.run([script, self.dir / "out", "--small"], env=env, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        text = (self.dir / "out/rehearsal.md").read_text()
        self.assertEqual(text, done.stdout)
        self.assertIn("tiny networks.", text)
        for preset in paper_rehearsal.PRESETS:
            part = re.split(r"(?m)^## ", text.partition(f"## {preset}\n")[2])[0]
            rows = {cells[0]: cells[1:] for cells in re.findall(r"(?m)^\| " + r" \| ".join(["([^|\n]*?)"] * 7) + r" \|$", part)[2:]}
            self.assertEqual(rows.keys() - {"together"} & STAGES, STAGES & rows.keys())
            self.assertTrue({"sfm", "depth", "propose", "validate", "train", "evaluate"} <= rows.keys(), rows)
            for stage in ("propose", "validate", "train"):
                took, _, memory, gpu, estimate, differs = rows[stage]
                self.assertRegex(took, r"^\d+\.\d s$", stage)
                self.assertRegex(memory, r"^\d\S* GB$", stage)
                self.assertEqual(gpu, "-")
                self.assertRegex(estimate, r"^\d\S* GB$", stage)
                self.assertRegex(differs, r"^[+-]\d+ %$", stage)

    def test_a_run_that_fails_is_told(self):
        script = ROOT / "scripts/paper_rehearsal.sh"
        env = os.environ | {"ORACLEGS_BIN": PROGRAM}
        arguments = [self.dir / "fails", "--small", "--preset", "paper-blender-8", "--models", self.dir / "none"]
        done = subprocess.run([script, *arguments], env=env, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stdout, r"\*\*Not finished:\*\* oraclegs: error: .*models fetch")

    def test_random_weights_have_the_published_names_and_shapes(self):
        models = self.dir / "models"
        for network in ("lpips-vgg", "depth-anything-v2-small"):
            stand_ins.write_random(network, models / network / "model.safetensors", stand_ins.Numbers(1))
            self.run_program("models", "check", network, env=os.environ | {"ORACLEGS_MODELS": str(models)})
        self.assertEqual(len(stand_ins.tensors_of("seva")), 1146)
        block = stand_ins.Numbers(1).block(-3)
        values = struct.unpack("<1000f", block[:4000])
        self.assertTrue(all(1 / 8 <= abs(value) < 1 / 4 for value in values))
        self.assertGreater(sum(value < 0 for value in values), 400)

    def test_photos_are_enlarged_and_reduced(self):
        traced = self.scene / "images/000.png"
        width, height, _, pixels = read_png(traced)
        large, small = self.dir / "large.png", self.dir / "small.png"
        stand_ins.write_enlarged(traced, large)
        self.assertEqual(read_png(large)[:2], (4 * width, 4 * height))
        stand_ins.write_reduced(large, small)
        self.assertEqual(read_png(small), (width, height, 3, pixels))
        one = self.dir / "one.png"
        one.write_bytes(png(8, 4, (1, 2, 3)))
        self.assertEqual(stand_ins.read_png(one), [bytes((1, 2, 3)) * 8] * 4)

    def test_memory_of_a_gpu_counts_from_the_beginning(self):
        with mock.patch.dict(os.environ, {"PATH": self.path_with(GPU)}):
            gpu = paper_rehearsal.Gpu()
            self.assertEqual(gpu.name, "Some GPU")
            subprocess.run(["sleep", "1"], check=True)
            self.assertEqual(gpu.bytes(), 1024 << 20)
            gpu.stop()
        with mock.patch.dict(os.environ, {"PATH": self.path_with(NO_GPU)}):
            self.assertIsNone(paper_rehearsal.Gpu().bytes())

    def test_time_of_steps_that_were_not_run_is_added(self):
        stage = SimpleNamespace(seconds=100.0, counts=[(0, 1, 20), (2, 2, 20), (4, 3, 20), (30, 4, 20)])
        self.assertEqual(paper_rehearsal.full_seconds(stage, 10, 10), 100)
        self.assertEqual(paper_rehearsal.full_seconds(stage, 10, 50), 100 + 2 * (100 - 20))
        stopped = SimpleNamespace(seconds=None, counts=stage.counts)
        self.assertEqual(paper_rehearsal.full_seconds(stopped, 10, 10), 2 * 20)
        stage.counts = []
        self.assertEqual(paper_rehearsal.full_seconds(stage, 10, 50), 500)
        stage.seconds = None
        self.assertIsNone(paper_rehearsal.full_seconds(stage, 10, 50))


if __name__ == "__main__":
    main()

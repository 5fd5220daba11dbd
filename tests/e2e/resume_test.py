#!/usr/bin/env python3
"""A run that is stopped, in whatever way, and started again ends with the same bits as one that never was."""

import os
import signal
import subprocess
import time

from harness import SMALL_RUN, EndToEnd, command, main


class Resume(EndToEnd):
    def stop_in_training(self, arguments, out, how):
        """Starts the program, stops it when a new checkpoint appears; returns the exit code."""
        folder = out / "checkpoints"
        before = set(os.listdir(folder)) if folder.exists() else set()
        process = subprocess.Popen(command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        while process.poll() is None:
            seen = set(os.listdir(folder)) if folder.exists() else set()
            if any(name.endswith(".safetensors") for name in seen - before):
                process.send_signal(how)
                break
            time.sleep(0.002)
        process.communicate(timeout=300)
        return process.returncode

    def test_same_bits_after_interrupt_and_kill_and_for_any_number_of_threads(self):
        straight, broken = self.dir / "straight", self.dir / "broken"
        self.run_program("reconstruct", self.scene, "-o", straight, "--threads", 2, *SMALL_RUN)
        arguments = ["reconstruct", self.scene, "-o", broken, "--threads", 1, "--checkpoint-every", 20, *SMALL_RUN]

        self.assertEqual(self.stop_in_training(arguments, broken, signal.SIGINT), 130)
        self.assertFalse((broken / "metrics.json").exists())
        # What it has so far is a splat, which says everywhere what it is.
        self.assertIn("unfinished", self.run_program("info", broken).stdout)
        exported = self.run_program("export", broken, "-o", self.dir / "so_far.spz")
        self.assertRegex(exported.stderr, r"its run was stopped: this is its model after \d+ of")
        self.error_of("evaluate", broken, code=3, names=["which has no scores"])

        other = [*arguments, "--seed", 5]
        self.error_of(*other, code=3, names=[broken, "--seed was 0, now is 5", "--overwrite"])

        self.assertEqual(self.stop_in_training(arguments, broken, signal.SIGTERM), 130)
        self.assertEqual(self.stop_in_training(arguments, broken, signal.SIGKILL), -signal.SIGKILL)
        # The number of threads and of checkpoints may change: they do not touch the result.
        done = self.run_program("reconstruct", self.scene, "-o", broken, "--threads", 2, *SMALL_RUN)
        self.assertIn("continuing from iteration", done.stderr)
        self.assertEqual((straight / "point_cloud.ply").read_bytes(), (broken / "point_cloud.ply").read_bytes())

        self.run_program(*other, "--overwrite", "--iterations", 20)
        self.assertNotEqual((straight / "point_cloud.ply").read_bytes(), (broken / "point_cloud.ply").read_bytes())

    def test_a_draft_goes_on_to_a_higher_quality_and_stays_until_then(self):
        out = self.dir / "raised"
        small = ["reconstruct", self.scene, "-o", out, "--max-size", 80, "--max-gaussians", 500, "--proposers", "none"]
        self.run_program(*small, "--quality", "draft", "--set", "horizon=40")
        draft = (out / "point_cloud.ply").read_bytes()

        normal = [*small, "--quality", "normal", "--set", "horizon=40", "--checkpoint-every", 5]
        self.assertEqual(self.stop_in_training(normal, out, signal.SIGKILL), -signal.SIGKILL)
        self.assertEqual((out / "point_cloud.ply").read_bytes(), draft)
        self.assertIn("splat of --quality draft", self.run_program("info", out).stdout)

        self.run_program(*normal)
        self.assertNotIn("unfinished", self.run_program("info", out).stdout)
        self.error_of(*small, "--quality", "draft", "--set", "horizon=40", code=3, names=[out, "--quality was normal"])


if __name__ == "__main__":
    main()

"""oraclegs.reconstruct: options, progress, errors, interrupts."""

import signal
import threading
import unittest

import fixtures
import oraclegs


class Reconstruct(unittest.TestCase):
    def test_returns_the_metrics_and_reports_progress(self):
        events, threads = [], set()

        def progress(*event):
            events.append(event)
            threads.add(threading.get_ident())

        metrics = oraclegs.reconstruct(fixtures.scene(), fixtures.folder() / "progress", progress=progress, **fixtures.SMALL)
        self.assertGreater(metrics["test"]["psnr"], 5)
        self.assertEqual(metrics["train"]["iterations"], 60)
        self.assertEqual(threads, {threading.get_ident()})
        self.assertIn(("train", 60, 60), [event[:3] for event in events])
        self.assertIn(("train", 0, 0, "started"), events)
        self.assertTrue(any(stage == "note" and "training views" in text for stage, _, _, text in events))

    def test_a_finished_run_is_kept(self):
        run = fixtures.finished_run()
        before = (run / "point_cloud.ply").read_bytes()
        events = []
        oraclegs.reconstruct(fixtures.scene(), run, progress=lambda *event: events.append(event), **fixtures.SMALL)
        self.assertIn(("evaluate", 1, 1, "kept"), events)
        self.assertNotIn("train", [stage for stage, *_ in events])
        self.assertEqual((run / "point_cloud.ply").read_bytes(), before)

    def test_unknown_options_are_named_with_what_was_meant(self):
        out = fixtures.folder() / "mistakes"
        with self.assertRaisesRegex(oraclegs.UsageError, "'iterationz'; did you mean 'iterations'"):
            oraclegs.reconstruct(fixtures.scene(), out, iterationz=5)
        with self.assertRaisesRegex(oraclegs.UsageError, "--init is 'thick', must be one of"):
            oraclegs.reconstruct(fixtures.scene(), out, init="thick")
        with self.assertRaisesRegex(oraclegs.UsageError, "--iterations is -1"):
            oraclegs.reconstruct(fixtures.scene(), out, iterations=-1)
        with self.assertRaisesRegex(oraclegs.UsageError, "--frames is 0"):
            oraclegs.reconstruct(fixtures.scene(), out, frames=0)
        self.assertFalse(out.exists())

    def test_takes_lists(self):
        run = fixtures.finished_run()
        oraclegs.reconstruct([fixtures.scene()], run, **fixtures.SMALL)  # the same as the folder itself
        photos = sorted((fixtures.scene() / "images").iterdir())[:2]
        text = fixtures.folder() / "notes.txt"
        text.write_text("no photo")
        with self.assertRaisesRegex(oraclegs.InputError, "notes.txt: is neither a photo"):
            oraclegs.reconstruct([*photos, text], fixtures.folder() / "list", **fixtures.SMALL)
        with self.assertRaisesRegex(oraclegs.Error, "photos"):  # two tell no depth
            oraclegs.reconstruct(photos, fixtures.folder() / "list", **fixtures.SMALL)

    def test_bad_input_is_an_input_error(self):
        with self.assertRaisesRegex(oraclegs.InputError, "nowhere"):
            oraclegs.reconstruct("/nowhere", fixtures.folder() / "x")
        self.assertTrue(issubclass(oraclegs.InputError, oraclegs.Error))

    def test_an_exception_of_the_callback_stops_the_run(self):
        class Stop(Exception):
            pass

        def progress(stage, done, total, detail):
            if stage == "train" and done > 0:
                raise Stop

        out = fixtures.folder() / "stopped"
        with self.assertRaises(Stop):
            oraclegs.reconstruct(fixtures.scene(), out, progress=progress, **{**fixtures.SMALL, "iterations": 100000})
        self.assertTrue(list((out / "checkpoints").glob("*.safetensors")))

    def test_an_interrupt_saves_a_checkpoint_and_the_same_call_goes_on_to_the_same_bits(self):
        options = {**fixtures.SMALL, "iterations": 1500}
        straight, out = fixtures.folder() / "straight", fixtures.folder() / "interrupted"
        oraclegs.reconstruct(fixtures.scene(), straight, **options)

        def interrupt(stage, done, total, detail):
            if stage == "train" and done > 0:
                signal.raise_signal(signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            oraclegs.reconstruct(fixtures.scene(), out, progress=interrupt, **options)
        self.assertNotEqual((out / "point_cloud.ply").read_bytes(), (straight / "point_cloud.ply").read_bytes())
        oraclegs.reconstruct(fixtures.scene(), out, **options)
        self.assertEqual((out / "point_cloud.ply").read_bytes(), (straight / "point_cloud.ply").read_bytes())

    def test_other_threads_run_meanwhile(self):
        done = threading.Event()
        steps = [0]

        def count():
            while not done.wait(0.001):
                steps[0] += 1

        thread = threading.Thread(target=count)
        thread.start()
        try:
            oraclegs.reconstruct(fixtures.scene(), fixtures.folder() / "threads", **fixtures.SMALL)
        finally:
            done.set()
            thread.join()
        self.assertGreater(steps[0], 5)

    def test_two_runs_at_a_time_are_refused(self):
        def progress(stage, done, total, detail):
            oraclegs.reconstruct(fixtures.scene(), fixtures.folder() / "second", **fixtures.SMALL)

        with self.assertRaisesRegex(oraclegs.UsageError, "another run is going on"):
            oraclegs.reconstruct(fixtures.scene(), fixtures.folder() / "first", progress=progress, **fixtures.SMALL)


if __name__ == "__main__":
    unittest.main()

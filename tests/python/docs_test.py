"""The example of docs/python.md runs as it stands."""

import contextlib
import io
import os
import re
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import fixtures
import numpy as np


class Documentation(unittest.TestCase):
    def test_the_example_runs(self):
        text = (fixtures.ROOT / "docs/python.md").read_text()
        (example,) = re.findall(r"```python\n(.*?)```", text, re.S)
        example = example.replace('"scene"', repr(str(fixtures.scene()))).replace("iterations=300", "iterations=30")
        before, names, printed = os.getcwd(), {}, io.StringIO()
        os.chdir(fixtures.folder())
        try:
            with warnings.catch_warnings(), contextlib.redirect_stdout(printed):
                warnings.simplefilter("ignore")
                exec(compile(example, "docs/python.md", "exec"), names)
        finally:
            os.chdir(before)
        self.assertEqual(names["image"].shape, (48, 64, 3))
        self.assertTrue(np.isfinite(names["psnr"][-1]))
        self.assertGreater(names["error"], 0)
        self.assertIn("PSNR of the test views:", printed.getvalue())

    def test_the_first_lines_run_in_a_build(self):
        text = (fixtures.ROOT / "docs/python.md").read_text()
        lines = re.search(r"```bash\n(.*?)```", text, re.S)[1]
        self.assertIn("PYTHONPATH=build/release/python", lines)
        lines = lines.replace("build/release/python", os.environ["PYTHONPATH"])
        ran = subprocess.run(["bash", "-ec", lines], capture_output=True, text=True, check=False)
        self.assertRegex(ran.stdout, r"^\d+\.\d+", ran.stderr)
        demo = (fixtures.ROOT / "scripts/demo.sh").read_text()
        self.assertIn("oraclegs_python", demo)

    def test_the_example_of_curves_logs_each_row_once(self):
        with tempfile.TemporaryDirectory() as place:
            out = Path(place) / "out"
            out.mkdir()
            (out / "metrics.json").write_text("{}")
            (out / "train.csv").write_text("iteration,loss,psnr\n3,0.5,\n6,0.25,20\n")
            stub = "class init:\n    def __init__(self, **_): pass\n    def log(self, values, step): print(step, values)\n"
            (Path(place) / "wandb.py").write_text(stub)
            script = fixtures.ROOT / "examples/curves/follow.py"
            command = [sys.executable, script, out, "--wandb"]
            ran = subprocess.run(command, env={**os.environ, "PYTHONPATH": place}, capture_output=True, text=True, check=True)
        self.assertEqual(ran.stdout, "3 {'loss': 0.5}\n6 {'loss': 0.25, 'psnr': 20.0}\n")

    def test_names_everything_that_is_exported(self):
        import oraclegs

        text = (fixtures.ROOT / "docs/python.md").read_text()
        for name in oraclegs.__all__:
            self.assertIn(name, text)


if __name__ == "__main__":
    unittest.main()

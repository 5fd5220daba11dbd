"""The example of docs/python.md runs as it stands."""

import contextlib
import io
import os
import re
import unittest
import warnings

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

    def test_names_everything_that_is_exported(self):
        import oraclegs

        text = (fixtures.ROOT / "docs/python.md").read_text()
        for name in oraclegs.__all__:
            self.assertIn(name, text)


if __name__ == "__main__":
    unittest.main()

"""The page of `oraclegs app` in headless Chromium (tests/browser/app.mjs)."""

import shutil
import subprocess
import unittest

from harness import PROGRAM, ROOT, EndToEnd, main


@unittest.skipUnless((ROOT / "web/node_modules/.package-lock.json").is_file(),
                     "the npm packages of web/ are not installed: run scripts/bootstrap.sh where registry.npmjs.org can be reached")  # fmt: skip
class AppPage(EndToEnd):
    def test_from_dropped_photos_to_a_downloaded_splat(self):
        node = shutil.which("node") or shutil.which("nodejs")
        self.assertIsNotNone(node, "Node.js is not installed: run scripts/bootstrap.sh")
        done = subprocess.run([node, ROOT / "tests/browser/app.mjs", "--program", PROGRAM],
                              capture_output=True, text=True, timeout=580, check=False)  # fmt: skip
        print(done.stdout, end="")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    main()

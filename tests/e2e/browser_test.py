"""The viewer and the report in headless Chromium (tests/browser)."""

import re
import shutil
import signal
import subprocess
import unittest
from pathlib import Path

from harness import PROGRAM, ROOT, SMALL_RUN, EndToEnd, command, main

PAGES = Path(PROGRAM).parent.parent / "web"  # what the build has bundled


@unittest.skipUnless((ROOT / "web/node_modules/.package-lock.json").is_file(),
                     "the npm packages of web/ are not installed: run scripts/bootstrap.sh where registry.npmjs.org can be reached")  # fmt: skip
class Browser(EndToEnd):
    def run_checks(self, *arguments):
        node = shutil.which("node") or shutil.which("nodejs")
        self.assertIsNotNone(node, "Node.js is not installed: run scripts/bootstrap.sh")
        done = subprocess.run([node, ROOT / "tests/browser/run.mjs", *map(str, arguments)],
                              capture_output=True, text=True, timeout=400, check=False)  # fmt: skip
        print(done.stdout, end="")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_pages_against_a_scene_of_known_truth(self):
        self.run_checks("--assets", PAGES)

    def test_the_report_and_the_viewer_of_a_run(self):
        out = self.dir / "run"
        self.run_program("reconstruct", self.scene, "-o", out, *SMALL_RUN)
        self.run_checks("--report", out / "report.html", "--only", "report_desktop")
        with subprocess.Popen(command("view", out, "--no-browser"), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as view:
            try:
                url = next(found.group() for line in view.stdout if (found := re.search(r"http://\S+", line)))
                self.run_checks("--url", url, "--only", "viewer_desktop")
            finally:
                view.send_signal(signal.SIGINT)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Another program is built against the installed CMake package and trains a few Gaussians (tests/consumer)."""

import subprocess
import unittest

from installed import CMAKE, ROOT, Installed


class Consumer(Installed):
    COMPONENTS = ("runtime", "dev")

    def run_command(self, *command):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
        return done.stdout

    def test_builds_and_trains(self):
        build = self.dir / "build"
        prefix = f"-DCMAKE_PREFIX_PATH={self.prefix}"
        self.run_command(CMAKE, "-G", "Ninja", "-S", ROOT / "tests/consumer", "-B", build, prefix)
        self.run_command(CMAKE, "--build", build)
        self.assertIn("mean error", self.run_command(build / "train_a_few"))

    def test_headers_need_no_others(self):
        """What an installed header includes is installed; headers with device code are not."""
        include = self.prefix / "include"
        for header in include.rglob("*.h"):
            for line in header.read_text().splitlines():
                if line.startswith('#include "oraclegs/') and "/cuda/" not in line:
                    self.assertTrue((include / line.split('"')[1]).exists(), f"{header}: {line}")

    def test_names_no_folder_of_the_sources(self):
        for file in self.prefix.glob("lib/**/cmake/oraclegs/*.cmake"):
            self.assertNotIn(str(ROOT), file.read_text(), file.name)


if __name__ == "__main__":
    unittest.main()

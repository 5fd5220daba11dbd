#!/usr/bin/env python3
"""THIRD_PARTY_NOTICES.md covers every library that is linked and every npm package that is bundled."""

import json
import subprocess
import unittest

from installed import ROOT, Installed


class Notices(Installed):
    COMPONENTS = ("runtime", "networks")

    def setUp(self):
        self.text = self.only("share/doc/oraclegs/THIRD_PARTY_NOTICES.md").read_text()

    def test_every_linked_library(self):
        for binary in [self.only("bin/oraclegs"), *self.prefix.glob("lib/**/*.so*")]:
            listed = subprocess.run(["readelf", "-d", binary], capture_output=True, text=True, check=True).stdout
            for line in listed.splitlines():
                if "(NEEDED)" in line and "liboraclegs" not in line:
                    self.assertIn(line.split("[")[1].rstrip("]"), self.text, f"needed by {binary.name}")

    def test_headers_that_are_compiled_in(self):
        for name in ("eigen3", "nlohmann-json3", "cli11"):
            self.assertRegex(self.text, rf"\| \[{name}\]\(.*compiled in \|")
            self.assertIn(f"\n## {name}\n", self.text, "with the text of its license")

    def test_every_npm_package(self):
        lock = json.loads((ROOT / "web/package-lock.json").read_text())["packages"]
        names = [path.removeprefix("node_modules/") for path, entry in lock.items() if path and not entry.get("dev")]
        self.assertIn("three", names)
        for name in names:
            self.assertIn(f"| [{name}](", self.text)

    def test_licenses_are_known(self):
        self.assertNotIn("| not known |", self.text)


if __name__ == "__main__":
    unittest.main()

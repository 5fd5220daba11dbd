#!/usr/bin/env python3
"""The check of hardened programs, with programs that are compiled here, and the preset of packages."""

import json
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHECK = ROOT / "packaging" / "check_hardening.sh"
SOURCE = """
#include <cstdio>
#include <cstring>
int main(int argc, char** argv) {
  char text[16];
  std::strcpy(text, argv[argc - 1]);
  std::printf("%s", text);
}
"""
COMPILED = ["-fstack-protector-strong", "-U_FORTIFY_SOURCE", "-D_FORTIFY_SOURCE=2"]
LINKED = ["-Wl,-z,relro,-z,now"]
PLAIN = ["-fno-stack-protector", "-U_FORTIFY_SOURCE", "-Wl,-z,lazy"]


class Hardening(unittest.TestCase):
    def complaints(self, *flags):
        with tempfile.TemporaryDirectory() as folder:
            source, program = Path(folder) / "a.cpp", Path(folder) / "a"
            source.write_text(SOURCE)
            subprocess.run(["c++", "-O2", *flags, source, "-o", program], check=True)
            done = subprocess.run([CHECK, program], stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(done.returncode != 0, done.stderr != "")
        return done.stderr

    def test_hardened_programs_pass(self):
        self.assertEqual(self.complaints(*COMPILED, *LINKED), "")

    def test_what_lacks_is_named(self):
        text = self.complaints(*PLAIN)
        for flag in ["-z,now", "-fstack-protector-strong", "-D_FORTIFY_SOURCE=2"]:
            self.assertIn(flag, text)
        self.assertIn("-D_FORTIFY_SOURCE=2", self.complaints(COMPILED[0], *LINKED, "-U_FORTIFY_SOURCE"))

    def test_packages_are_compiled_so_and_checked(self):
        presets = json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]
        package = next(preset for preset in presets if preset["name"] == "package")
        self.assertEqual(package["cacheVariables"]["ORACLEGS_HARDENING"], "ON")
        flags = (ROOT / "cmake" / "Targets.cmake").read_text()
        for flag in COMPILED:
            self.assertIn(flag, flags)
        self.assertIn("check_hardening.sh build/package/bin/oraclegs", (ROOT / "packaging" / "build.sh").read_text())


if __name__ == "__main__":
    unittest.main()

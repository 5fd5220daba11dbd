#!/usr/bin/env python3
"""The installed tree runs from any folder, knows nothing of the sources, and has its pages."""

import gzip
import os
import re
import subprocess
import unittest

from installed import BUILD, ROOT, Installed


class Tree(Installed):
    COMPONENTS = ("runtime", "networks")

    def run_moved(self, *arguments):
        return subprocess.run([self.moved / "bin/oraclegs", *arguments], capture_output=True, text=True, check=True,
                              cwd="/", env={"PATH": os.environ["PATH"], "HOME": str(self.dir)}).stdout  # fmt: skip

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.moved = cls.dir / "another place"
        cls.prefix.rename(cls.moved)
        cls.prefix = cls.moved

    def binaries(self):
        return [self.only("bin/oraclegs"), *sorted(self.prefix.glob("lib/**/*.so*"))]

    def test_runs_where_it_was_moved_to(self):
        self.assertRegex(self.run_moved("--version"), r"^oraclegs \d+\.\d+\.\d+")
        size = ["--demo-views", "2", "--width", "32", "--height", "24", "--samples", "1"]
        self.run_moved("demo-scene", self.dir / "scene", "--quiet", *size)
        self.assertTrue((self.dir / "scene/transforms.json").exists())

    def test_loads_its_own_libraries(self):
        listed = subprocess.run(["ldd", self.only("bin/oraclegs")], capture_output=True, text=True, check=True).stdout
        core = re.search(r"liboraclegs_core\.so => (.*) \(", listed).group(1)
        self.assertTrue(os.path.samefile(core, self.only("lib/**/liboraclegs_core.so")), core)
        self.assertNotIn("not found", listed)

    def test_search_paths_are_relative(self):
        for binary in self.binaries():
            text = subprocess.run(["readelf", "-d", binary], capture_output=True, text=True, check=True).stdout
            for paths in re.findall(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", text):
                for path in paths.split(":"):
                    self.assertTrue(path.startswith("$ORIGIN"), f"{binary.name}: {path}")

    def test_names_no_folder_of_the_sources(self):
        for binary in self.binaries():
            for folder in (ROOT, BUILD):
                self.assertFalse(str(folder).encode() in binary.read_bytes(), f"{binary.name} names {folder}")

    def test_documents(self):
        for name in ("LICENSE", "README.md", "CHANGELOG.md", "THIRD_PARTY_NOTICES.md", "docs/commands.md"):
            self.assertGreater((self.prefix / "share/doc/oraclegs" / name).stat().st_size, 100, name)

    def test_manual_and_completions(self):
        manual = gzip.decompress(self.only("share/man/man1/oraclegs.1.gz").read_bytes()).decode()
        self.assertIn("reconstruct", manual)
        for file in ("bash-completion/completions/oraclegs", "zsh/vendor-completions/_oraclegs",
                     "fish/vendor_completions.d/oraclegs.fish"):  # fmt: skip
            self.assertIn("reconstruct", (self.prefix / "share" / file).read_text(), file)


if __name__ == "__main__":
    unittest.main()

"""What the tests of the installation share: the built tree, installed into a temporary folder."""

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("ORACLEGS_BUILD", ROOT / "build/release"))
CMAKE = os.environ.get("ORACLEGS_CMAKE", "cmake")


def install(prefix, *components):
    for component in components:
        command = [CMAKE, "--install", BUILD, "--prefix", prefix, "--component", component]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


class Installed(unittest.TestCase):
    """A test case whose `prefix` has the components named in COMPONENTS."""

    COMPONENTS = ()

    @classmethod
    def setUpClass(cls):
        cls.dir = Path(tempfile.mkdtemp(prefix="oraclegs install "))
        cls.addClassCleanup(shutil.rmtree, cls.dir, ignore_errors=True)
        cls.prefix = cls.dir / "prefix"
        install(cls.prefix, *cls.COMPONENTS)

    def only(self, pattern):
        """The one installed file of that pattern."""
        found = sorted(self.prefix.glob(pattern))
        self.assertEqual(len(found), 1, pattern)
        return found[0]

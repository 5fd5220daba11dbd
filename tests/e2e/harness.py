"""What the end-to-end tests share: the built program, a small demo scene, pictures without a library."""

import json
import os
import shutil
import struct
import subprocess
import tempfile
import unittest
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("ORACLEGS_BIN", str(ROOT / "build/release/bin/oraclegs"))
os.environ["ORACLEGS_MODELS"] = "/nonexistent"  # the tests see no weights of whoever runs them

DEMO = ["--demo-views", "8", "--width", "96", "--height", "72", "--samples", "1"]
SMALL_RUN = ["--iterations", "200", "--max-gaussians", "2000", "--random-points", "1500", "--init", "random",
             "--proposers", "none", "--test-every", "4", "--sh-degree-interval", "60", "--refine-start", "50", "--refine-every", "25"]  # fmt: skip


def command(*arguments):
    return [PROGRAM, *map(str, arguments)]


class EndToEnd(unittest.TestCase):
    """A test case with a folder of its own and a demo scene that all its tests share and may only copy."""

    @classmethod
    def setUpClass(cls):
        cls.dir = Path(tempfile.mkdtemp(prefix="oraclegs_e2e_"))
        cls.addClassCleanup(shutil.rmtree, cls.dir, ignore_errors=True)
        cls.scene = cls.dir / "scene"
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *DEMO), check=True)

    def run_program(self, *arguments, code=0, **options):
        """Runs the program and requires its exit code; returns the finished process."""
        done = subprocess.run(command(*arguments), capture_output=True, text=True, timeout=300, check=False, **options)
        self.assertEqual(done.returncode, code, f"oraclegs {' '.join(map(str, arguments))}\n{done.stdout}{done.stderr}")
        return done

    def error_of(self, *arguments, code, names=(), **options):
        """The one error line of a command that must fail; it names all of `names`."""
        done = self.run_program(*arguments, code=code, **options)
        lines = [line for line in done.stderr.splitlines() if line.startswith("oraclegs: error: ")]
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(done.stderr.rstrip("\n").endswith(lines[0]), f"the error is not the last line:\n{done.stderr}")
        for name in names:
            self.assertIn(str(name), lines[0])
        return lines[0]

    def copy_scene(self, name):
        return Path(shutil.copytree(self.scene, self.dir / name))

    def edit_transforms(self, scene, edit):
        path = scene / "transforms.json"
        transforms = json.loads(path.read_text())
        edit(transforms)
        path.write_text(json.dumps(transforms))
        return path


def files_below(folder):
    """{relative path: (bytes, time of change)} of every file."""
    files = [p for p in sorted(folder.rglob("*")) if p.is_file()]
    return {str(p.relative_to(folder)): (p.read_bytes(), p.stat().st_mtime_ns) for p in files}


def png(width, height, rgb):
    """A PNG of one colour."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = (b"\0" + bytes(rgb) * width) * height
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def main():
    unittest.main(verbosity=2)

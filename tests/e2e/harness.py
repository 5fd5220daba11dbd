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
SMALL_RUN = ["--iterations", "200", "--max-gaussians", "2000", "--set", "random-points=1500", "--init", "random",
             "--proposers", "none", "--test-every", "4", "--set", "sh-degree-interval=60", "--set", "refine-start=50", "--set", "refine-every=25"]  # fmt: skip


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


class ManyViews(EndToEnd):
    """The same with 20 small views, enough for proposals at poses that neither train nor test."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.dir / "views"
        size = ["--demo-views", 20, "--width", 80, "--height", 60, "--samples", 1]
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *size), check=True)


def files_below(folder):
    """{relative path: (bytes, time of change)} of every file."""
    files = [p for p in sorted(folder.rglob("*")) if p.is_file()]
    return {str(p.relative_to(folder)): (p.read_bytes(), p.stat().st_mtime_ns) for p in files}


def write_png(width, height, channels, data):
    """A PNG of 8-bit gray (1) or RGB (3), rows top to bottom."""

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    row = width * channels
    rows = b"".join(b"\0" + bytes(data[y * row : (y + 1) * row]) for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 3: 2}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def png(width, height, rgb):
    """A PNG of one color."""
    return write_png(width, height, 3, bytes(rgb) * (width * height))


def read_png(path):
    """(width, height, channels, bytearray) of an 8-bit PNG that is not interlaced."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        at += 12 + length
        if kind == b"IHDR":
            width, height, depth, color, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert depth == 8 and interlaced == 0
        packed += body if kind == b"IDAT" else b""
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[color]
    raw, row = zlib.decompress(packed), width * channels
    pixels, above = bytearray(), bytes(row)
    for y in range(height):
        begin = y * (row + 1)
        line = bytearray(raw[begin + 1 : begin + 1 + row])
        for i in range(row):
            left, corner = (line[i - channels], above[i - channels]) if i >= channels else (0, 0)
            line[i] = (line[i] + _predicted(raw[begin], left, above[i], corner)) & 255
        pixels += line
        above = line
    return width, height, channels, pixels


def _predicted(rule, left, above, corner):
    """What the filter of a PNG's row adds to a byte."""
    if rule < 4:
        return (0, left, above, (left + above) // 2)[rule]
    estimate = left + above - corner
    return min((left, above, corner), key=lambda value: abs(estimate - value))


def main():
    unittest.main(verbosity=2)

"""What the tests of the package share: a small scene, and a run of it that is made once in a process."""

import atexit
import functools
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

os.environ["ORACLEGS_MODELS"] = "/nonexistent"  # the tests see no weights of whoever runs them

import oraclegs  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
SMALL = {"iterations": 60, "max_gaussians": 800, "random_points": 600, "init": "random", "proposers": "none", "test_every": 4, "depth_prior": "none", "report": False}  # fmt: skip


@functools.cache
def folder() -> Path:
    path = Path(tempfile.mkdtemp(prefix="oraclegs_python_"))
    atexit.register(shutil.rmtree, path, ignore_errors=True)
    return path


@functools.cache
def scene() -> Path:
    size = ["--demo-views", "8", "--width", "64", "--height", "48", "--samples", "1"]
    subprocess.run([os.environ["ORACLEGS_BIN"], "demo-scene", folder() / "scene", "--quiet", *size], check=True)
    return folder() / "scene"


@functools.cache
def finished_run() -> Path:
    oraclegs.reconstruct(scene(), folder() / "run", **SMALL)
    return folder() / "run"

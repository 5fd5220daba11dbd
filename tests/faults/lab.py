"""What the tests of faults share: a small scene, the program with fake helpers, and what must hold after any fault."""

import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "e2e"))
from harness import PROGRAM  # noqa: E402

STAGES = ["register", "sfm", "poses", "depth", "proxies", "propose", "validate", "train", "evaluate", "report"]
SMALL = ["--iterations", 80, "--max-gaussians", 1500, "--set", "stereo-iterations=2", "--set", "stereo-passes=1", "--proposals", 4,
         "--set", "proxy-models=2", "--test-every", 4, "--set", "orbit-frames=8", "--checkpoint-every", 20, "--set", "refine-start=20",
         "--set", "refine-every=10", "--set", "sh-degree-interval=20"]  # fmt: skip
STARTED = re.compile(r"info: (?:\[\d+/\d+\] )?(\w+): started")
ERROR = "oraclegs: error: "
RECORDS = ["options.json", "split.json", "stages.json", "metrics.json", "frame.json", "live/state.json",
           "report/run.json", "photo_checks.json", "sfm/registration.json", "sfm/inputs.json",
           "sfm/training_views/inputs.json", "depth/depth_params.json"]  # fmt: skip
# What a run makes that must be the same bits each time. Other files hold times: metrics.json without them.
RESULTS = ["point_cloud.ply", "exposures.json", "split.json", "frame.json", "oracle.json", "depth", "proposals",
           "confidence", "renders/test", "report/splat.spz", "report/points.bin", "report/support.bin",
           "report/images"]  # fmt: skip
TIMES = re.compile(r"seconds|milliseconds|memory|per_second|^threads$|^checkpoint-every$")
GRACE = 6  # seconds within which whatever a killed run started must be gone
SCENE = ["--demo-views", 10, "--width", 96, "--height", 72, "--samples", 1]


def some(cases, count):
    """All cases with ORACLEGS_ALL_FAULTS=1; else that many, evenly, for tests that must be quick."""
    cases = list(cases)
    if os.environ.get("ORACLEGS_ALL_FAULTS") or count >= len(cases):
        return cases
    return [cases[i * len(cases) // count] for i in range(count)]


class Broken(AssertionError):
    """Something that must hold does not."""


def require(holds, text):
    if not holds:
        raise Broken(text)


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(item) for key, item in value.items() if not TIMES.search(key)}
    return [without_times(item) for item in value] if isinstance(value, list) else value


def fingerprint(folder):
    """{relative path: (digest or link, rights, time of change)} of everything below a folder."""
    found = {}
    for path in sorted(folder.rglob("*")):
        info = path.lstat()
        content = ""
        if path.is_symlink():
            content = os.readlink(path)
        elif path.is_file():
            content = hashlib.sha256(path.read_bytes()).hexdigest()
        found[str(path.relative_to(folder))] = (content, info.st_mode, info.st_mtime_ns if path.is_file() else 0)
    return found


def results(out):
    """{name: digest} of what must not depend on how a run came to its end."""
    found = {}
    for name in RESULTS:
        path = out / name
        for file in sorted(path.rglob("*")) if path.is_dir() else [path] if path.exists() else []:
            if file.is_file():
                found[str(file.relative_to(out))] = hashlib.sha256(file.read_bytes()).hexdigest()
    found["metrics.json"] = json.dumps(without_times(json.loads((out / "metrics.json").read_text())), sort_keys=True)
    return found


def difference(a, b):
    return sorted(name for name in a.keys() | b.keys() if a.get(name) != b.get(name))


class Run:
    """A running program: its stderr, line by line, with the stage that it is in."""

    def __init__(self, argv, **options):
        self.stage, self.lines, self.begun = "start", [], {"start": time.monotonic()}
        self.new_stage = threading.Condition()
        self.process = subprocess.Popen(argv, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE, **options)  # fmt: skip
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for raw in self.process.stderr:
            line = raw.decode(errors="replace").rstrip("\n")
            started = STARTED.match(line)
            with self.new_stage:
                self.lines.append(line)
                if started and started[1] in STAGES:
                    self.stage = started[1]
                    self.begun[self.stage] = time.monotonic()
                    self.new_stage.notify_all()
        with self.new_stage:
            self.begun["end"] = time.monotonic()
            self.new_stage.notify_all()

    def wait_for(self, stage, limit=120):
        """False when the run ended without it."""
        with self.new_stage:
            self.new_stage.wait_for(lambda: stage in self.begun or "end" in self.begun, limit)
            return stage in self.begun

    def wait(self, limit=120):
        """The exit code, and what the program wrote to stderr."""
        try:
            code = self.process.wait(limit)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            self.process.stderr.close()
            raise Broken(f"hangs in {self.stage}:\n{self.text()}") from None
        self.reader.join(GRACE)
        self.process.stderr.close()
        return code, self.text()

    def text(self):
        return "\n".join(self.lines)


class Lab:
    """A folder with a scene, photos without poses, and places that must stay empty."""

    def __init__(self, program=PROGRAM, scene=None, real_colmap=False):
        self.program = program
        self.dir = Path(tempfile.mkdtemp(prefix="oraclegs_faults_")).resolve()
        self.scene, self.photos, self.programs = self.dir / "scene", self.dir / "my photos", self.dir / "programs"
        self.home, self.temporary, self.current = self.dir / "home", self.dir / "tmp", self.dir / "current"
        for folder in (self.photos, self.programs, self.home, self.temporary, self.current):
            folder.mkdir()
        self.mark = f"oraclegs-fault-{os.getpid()}-{self.dir.name}"
        subprocess.run([program, "demo-scene", self.scene, "--quiet", *map(str, scene or SCENE)], check=True)
        for image in sorted((self.scene / "images").iterdir()):
            shutil.copy2(image, self.photos)
        if not real_colmap:
            self.fake("colmap", f"exec {sys.executable} -IS '{HERE / 'fake_colmap.py'}' \"$@\"")
        self.environment = {**os.environ, "PATH": f"{self.programs}:{os.environ['PATH']}", "HOME": str(self.home),
                            "TMPDIR": str(self.temporary), "ORACLEGS_MODELS": "/nonexistent",
                            "ORACLEGS_FAULT_MARK": self.mark, "FAKE_COLMAP_SCENE": str(self.scene),
                            "FAKE_COLMAP_SECONDS": "0.02"}  # fmt: skip
        self.inputs = (fingerprint(self.scene), fingerprint(self.photos))

    def close(self):
        for pid in self.alive():
            os.kill(pid, signal.SIGKILL)
        shutil.rmtree(self.dir, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def fake(self, name, body):
        """A program of that name which is found first."""
        path = self.programs / name
        path.write_text(f"#!/bin/sh\n{body}\n")
        path.chmod(0o755)

    def arguments(self, out, *more, source=None, command="reconstruct"):
        return [str(word) for word in (self.program, command, source or self.photos, "-o", out, *SMALL, *more)]

    def start(self, out, *more, source=None, command="reconstruct", environment=None, **options):
        """Starts the program on a folder; nothing that it leaves elsewhere stays unseen."""
        return Run(self.arguments(out, *more, source=source, command=command), cwd=self.current,
                   env={**self.environment, **(environment or {})}, **options)  # fmt: skip

    def finish(self, out, *more, **options):
        """Runs the program to its end, which must be a good one."""
        code, text = self.start(out, *more, **options).wait()
        require(code == 0, f"exit code {code}:\n{text}")
        return text

    def alive(self):
        """Processes that some run of this lab started and that still run."""
        found = []
        for entry in Path("/proc").iterdir():
            if not entry.name.isdigit() or int(entry.name) == os.getpid():
                continue
            try:
                if f"ORACLEGS_FAULT_MARK={self.mark}".encode() not in (entry / "environ").read_bytes():
                    continue
                if (entry / "stat").read_text().rpartition(")")[2].split()[0] not in "ZX":
                    found.append(int(entry.name))
            except OSError:
                continue  # it ended meanwhile
        return found

    def check_no_orphans(self):
        deadline = time.monotonic() + GRACE
        while self.alive() and time.monotonic() < deadline:
            time.sleep(0.01)
        left = [Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode() for pid in self.alive()]
        require(not left, f"still run: {left}")

    def check_surroundings(self):
        """The input is as it was, and nothing lies where nothing should."""
        require((fingerprint(self.scene), fingerprint(self.photos)) == self.inputs, "the input was changed")
        for folder in (self.temporary, self.current, self.home):
            stray = [str(path) for path in folder.rglob("*")]
            require(not stray, f"stray files: {stray}")

    def check_records(self, out):
        """Each record that is there can be read."""
        for name in RECORDS:
            try:
                text = (out / name).read_text()
            except OSError:
                continue
            try:
                json.loads(text)
            except ValueError as error:
                raise Broken(f"{name}: {error}: {text[:100]}") from None

    def check_finished(self, out, reference):
        """The same bits as the reference, and nothing half done."""
        self.check_records(out)
        left = [str(path) for path in out.rglob("*") if path.name.endswith(".tmp") or path.name.startswith(".oraclegs")]
        require(not left, f"left in the workspace: {left}")
        other = difference(results(out), reference)
        require(not other, f"other bits than those of an undisturbed run: {other[:8]}")


def error_of(text):
    """The one error line, which is the last."""
    lines = [line for line in text.splitlines() if line.startswith(ERROR)]
    require(len(lines) == 1, f"{len(lines)} error lines:\n{text}")
    require(text.rstrip("\n").endswith(lines[0]), f"the error is not the last line:\n{text}")
    require(lines[0].isprintable(), f"control characters: {lines[0]!r}")
    require("internal error" not in lines[0], lines[0])
    return lines[0][len(ERROR) :]


def table(rows, titles):
    """The rows as aligned columns."""
    cells = [list(map(str, row)) for row in [titles, *rows]]
    widths = [max(len(row[i]) for row in cells) for i in range(len(titles))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in cells)

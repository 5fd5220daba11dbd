#!/usr/bin/env python3
"""Runs the paper's presets from end to end at full size and measures time and memory of each stage.

The scenes are stand-ins: the ray-traced demo scene in the layout and the size of the datasets. The weights are random
numbers under the names and in the shapes of the published files, unless --models names a folder with those: time and
memory are the same, the pictures are not. What was made in OUT is used again by the next call; OUT/rehearsal.md gets the
tables. Needs a built program, and nothing from the net.

  scripts/paper_rehearsal.sh OUT                              # all three presets; 12 GB of weights are made
  scripts/paper_rehearsal.sh OUT --models ~/.cache/oraclegs   # with the real weights
  scripts/paper_rehearsal.sh OUT --preset paper-mipnerf360-12 --steps 4 --iterations 500   # all sizes, less of each
  timeout 540 scripts/paper_rehearsal.sh OUT --preset paper-blender-8   # tables of what was run until then
  scripts/paper_rehearsal.sh OUT --small                      # tiny networks and scenes, on the CPU, in a minute or two
"""

import argparse
import json
import math
import os
import re
import shutil
import signal
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path

from stand_ins import TRAIN_8, Failed, make_blender, make_mipnerf360, make_weights, say

ROOT = Path(__file__).resolve().parent.parent
PRESETS = ["paper-mipnerf360-12", "paper-mipnerf360-24", "paper-blender-8"]
STEPS, ITERATIONS = 50, {"paper-mipnerf360-12": 15000, "paper-mipnerf360-24": 22000, "paper-blender-8": 15000}
SMALL = ["--max-gaussians", "1500", "--seva-frames", "28", "--seva-short-side", "64", "--device", "cpu"]
SECONDS_OF_SAMPLE = 0.05
GB = 1e9


def make_scene(preset, options):
    """Returns the folder, and what the scene is in words."""
    small, program = options.small, options.program
    if preset == "paper-blender-8":
        side = 160 if small else 800
        train = sorted(TRAIN_8 + [n for n in range(100) if n not in TRAIN_8][: 4 if small else 92])
        scene = options.out / f"scenes/blender_{side}"
        if not scene.exists():
            make_blender(program, scene, train, (side, side))
        return scene, f"8 of {len(train)} images, {side}x{side} on disk and half of it as scored, {len(train) - 8} withheld poses"
    size = (48, 32) if small else (1237, 822)
    scene = options.out / f"scenes/mipnerf360_{options.images}_{size[0]}"
    if not scene.exists():
        make_mipnerf360(program, scene, options.images, size)
    views = int(preset.rpartition("-")[2])
    withheld = options.images - math.ceil(options.images / 8) - views
    return scene, f"{views} of {options.images} images of {size[0]}x{size[1]}, {withheld} withheld poses"


class Gpu:
    """Memory in use on the GPU, as its driver counts it, from the time that this is made. None where there is no GPU."""

    def __init__(self):
        self.used = self.before = None
        device = os.environ.get("CUDA_VISIBLE_DEVICES", "0").partition(",")[0] or "0"
        query = ["nvidia-smi", f"--id={device}", "--format=csv,noheader,nounits"]
        try:
            first = subprocess.run([*query, "--query-gpu=memory.used,name"], capture_output=True, text=True, check=True).stdout
            used, self.name = first.strip().split(", ", 1)
            self.used = self.before = int(used) << 20
            self.process = subprocess.Popen([*query, "--query-gpu=memory.used", "-lms", "50"], stdout=subprocess.PIPE, text=True)
            threading.Thread(target=self.follow, daemon=True).start()
        except (OSError, ValueError, subprocess.CalledProcessError):
            self.name = self.process = None

    def follow(self):
        for line in self.process.stdout:
            if line.strip().isdigit():
                self.used = int(line) << 20

    def bytes(self):
        return None if self.process is None else self.used - self.before

    def stop(self):
        if self.process is not None:
            self.process.terminate()
            self.process.wait()


def resident_of_session(session):
    """Memory of all processes of a session, bytes: the program's and of those that it starts, as COLMAP is."""
    pages = 0
    for folder in os.listdir("/proc"):
        if not folder.isdigit():
            continue
        try:
            fields = Path(f"/proc/{folder}/stat").read_text().rpartition(")")[2].split()
        except OSError:  # it has ended
            continue
        if int(fields[3]) == session:
            pages += int(fields[21])
    return pages * os.sysconf("SC_PAGE_SIZE")


class Stage:
    def __init__(self):
        self.host = 0  # peak, bytes
        self.device = None  # the same; None = there is no GPU
        self.estimate = None  # the program's, bytes
        self.seconds = None  # None = it did not end
        self.counts = []  # [(seconds, done, total)] of its steps


class Run:
    """A run of the program, with what its stages take. `stages` are in their order."""

    STARTED = re.compile(r"(?:\[\d+/\d+\] )?([a-z]+): (started|done in)")
    STEP = re.compile(r"(?:\[\d+/\d+\] )?([a-z]+): (\d+)/(\d+) (?:denoising steps|iterations) ")
    ESTIMATE = re.compile(r"needs (?:at most )?about ([0-9.e+-]+) GB")

    def __init__(self, command, env, log):
        self.stages, self.now, self.whole_run = {}, None, None
        self.gpu = Gpu()
        self.begin = time.monotonic()
        self.process = subprocess.Popen(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                                        start_new_session=True)  # fmt: skip
        self.ended = threading.Event()
        sampler = threading.Thread(target=self.sample)
        sampler.start()
        self.last, self.stopped = "", False
        try:
            with open(log, "w") as out:
                for line in self.process.stdout:
                    out.write(line)
                    out.flush()
                    self.take(line)
        except KeyboardInterrupt:
            self.stopped = True
            self.process.terminate()
        self.code = self.process.wait()
        self.ended.set()
        sampler.join()
        self.gpu.stop()

    def take(self, line):
        text = line.partition(": ")[2]
        self.last = line.strip() or self.last
        if found := self.STARTED.match(text):
            self.now = self.stages.setdefault(found[1], Stage()) if found[2] == "started" else None
        elif found := self.STEP.match(text):
            self.stages[found[1]].counts.append((time.monotonic(), int(found[2]), int(found[3])))
        elif found := self.ESTIMATE.search(text):
            if self.now is None:
                self.whole_run = float(found[1]) * GB
            else:
                self.now.estimate = float(found[1]) * GB

    def sample(self):
        while not self.ended.wait(SECONDS_OF_SAMPLE):
            stage = self.now
            if stage is None:
                continue
            stage.host = max(stage.host, resident_of_session(self.process.pid))
            if (used := self.gpu.bytes()) is not None:
                stage.device = max(stage.device or 0, used)


def full_seconds(stage, done, whole):
    """What the stage would take with `whole` steps in the place of `done`, from the time between its reports: those of a stage
    that was stopped as well."""
    steps = [(b[0] - a[0]) / (b[1] - a[1]) for a, b in zip(stage.counts, stage.counts[1:], strict=False) if b[1] > a[1]]
    if done == whole and stage.seconds is not None:
        return stage.seconds
    if not steps:  # too short for a report
        return None if stage.seconds is None else stage.seconds * whole / done
    all_steps = statistics.median(steps) * stage.counts[-1][2]
    return all_steps * whole / done if stage.seconds is None else stage.seconds + all_steps * (whole / done - 1)


def rehearse(preset, options):
    """Returns the lines of its table, and whether the run ended well."""
    scene, words = make_scene(preset, options)
    out = options.out / "runs" / preset
    shutil.rmtree(out, ignore_errors=True)
    out.parent.mkdir(exist_ok=True)
    command = [options.program, "reconstruct", scene, "-o", out, "--preset", preset, "--no-report", *(SMALL if options.small else [])]
    if options.steps:
        command += ["--set", f"seva-steps={options.steps}"]
    if options.iterations:
        command += ["--iterations", options.iterations]
    command = [str(word) for word in command + options.more]
    say(" ".join(command))
    run = Run(command, os.environ | {"ORACLEGS_MODELS": str(options.models)}, out.with_suffix(".log"))
    try:
        records = json.loads((out / "stages.json").read_text())
    except (OSError, ValueError):
        records = {}
    for name, stage in run.stages.items():
        stage.seconds = records.get(name, {}).get("seconds")
    on_gpu = run.gpu.name is not None and any(stage.device for stage in run.stages.values())
    if not on_gpu and "train" in run.stages:
        run.stages["train"].estimate = run.whole_run
    return table(preset, words, run, options, on_gpu), run


def table(preset, words, run, options, on_gpu):
    cut = {"propose": (options.steps or STEPS, STEPS), "train": (options.iterations or ITERATIONS[preset], ITERATIONS[preset])}
    lines = [f"## {preset}", "", words + ".", "",
             "| stage | time | at full length | memory | GPU memory | program's estimate | it differs by |",
             "| --- | --- | --- | --- | --- | --- | --- |"]  # fmt: skip
    size = lambda value: "-" if value is None else f"{value / GB:.3g} GB"
    seconds = lambda value: "-" if value is None else f"{value:.1f} s"
    total = whole = 0
    for name, stage in run.stages.items():
        full = full_seconds(stage, *cut[name]) if name in cut else stage.seconds
        total, whole = total + (stage.seconds or 0), whole + (full or 0)
        measured = stage.device if on_gpu else stage.host
        differs = f"{100 * (stage.estimate / measured - 1):+.0f} %" if stage.estimate and measured else "-"
        lines.append("| " + " | ".join([name, seconds(stage.seconds), seconds(full), size(stage.host or None), size(stage.device),
                                        size(stage.estimate), differs]) + " |")  # fmt: skip
    lines += [f"| together | {seconds(total)} | {seconds(whole)} | | | | |", ""]
    if run.code:
        lines += [f"**Not finished:** {'it was stopped.' if run.stopped else run.last}", ""]
    return lines


NOTES = """\
- *time*: as the run records it; of *propose*, *depth* and *validate* with the loading of their weights.
- *at full length*: with 50 denoising steps and the preset's iterations, from the time of those that were run. Iterations of a
  shortened training are of few Gaussians and few proposals: there it is a lower bound.
- *memory*: largest resident memory during the stage, of the program and of those that it starts (COLMAP), with the pages of
  weights that are mapped.
- *GPU memory*: largest use by the driver's count, above that before the run: with CUDA's own context, and with what libtorch
  keeps to use again.
- *program's estimate*: what it says before it begins (of *train* on a CPU: of the whole run beside its networks), against the GPU's
  memory where there is one; it leaves out CUDA's context.
"""


def machine(gpu, models):
    model = re.search(r"(?m)^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text())
    cores = len(os.sched_getaffinity(0))
    return f"{gpu or 'No GPU'}; {cores} cores of {model[1] if model else 'an unknown CPU'}; {models}."


def main():
    parser = argparse.ArgumentParser(prog="paper_rehearsal.sh", description=__doc__, epilog="What stands behind -- goes to reconstruct.",
                                     formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for weights, scenes, runs and the tables")
    parser.add_argument("--preset", action="append", choices=PRESETS, help="this one alone; may be given again")
    parser.add_argument("--models", type=Path, help="folder with the real weights, as $ORACLEGS_MODELS")
    parser.add_argument("--images", type=int, help="images of the stand-in for Mip-NeRF 360: 125 as stump has (default), up to 311 as room has")
    parser.add_argument("--steps", type=int, help="denoising steps of SEVA; time is extrapolated to 50")
    parser.add_argument("--iterations", type=int, help="iterations of the training; time is extrapolated to the preset's")
    parser.add_argument("--small", action="store_true", help="tiny networks and scenes, on the CPU")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of the built program")
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)
    options = parser.parse_args(words[:end])
    options.more = words[end + 1 :]
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # the table of what was run is written
    options.program = os.environ.get("ORACLEGS_BIN", str(options.bin / "oraclegs"))
    if options.small:
        options.steps, options.iterations = options.steps or 2, options.iterations or 20
    options.images = options.images or (32 if options.small else 125)
    made = options.models is None
    options.models = options.models or options.out / ("models_small" if options.small else "models")
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "scenes").mkdir(exist_ok=True)
    weights = "tiny networks" if options.small and made else "random weights of full size" if made else f"weights of {options.models}"
    lines, failed, gpu = [], False, None
    try:
        if made:
            make_weights(options.models, options.small, options.bin)
        for preset in options.preset or PRESETS:
            part, run = rehearse(preset, options)
            lines, failed, gpu = lines + part, failed or run.code != 0, run.gpu.name
            text = "\n".join(["# Rehearsal of the paper's presets", "", machine(gpu, weights), "", *lines]) + "\n" + NOTES
            (options.out / "rehearsal.md").write_text(text)
            if run.stopped:
                break
    except (Failed, OSError) as error:
        sys.exit(f"paper_rehearsal.sh: {error}")
    print(text, end="")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

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
import multiprocessing
import os
import re
import shutil
import signal
import statistics
import struct
import subprocess
import sys
import threading
import time
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LISTS = ROOT / "src/oraclegs/weights/lists"
NETWORKS = ["depth-anything-v2-small", "seva", "sd21-vae", "openclip-vith14", "vggt", "lpips-vgg"]
PRESETS = ["paper-mipnerf360-12", "paper-mipnerf360-24", "paper-blender-8"]
STEPS, ITERATIONS = 50, {"paper-mipnerf360-12": 15000, "paper-mipnerf360-24": 22000, "paper-blender-8": 15000}
TRAIN_8 = [26, 86, 2, 55, 75, 93, 16, 73]  # of paper-blender-8
SMALL = ["--max-gaussians", "1500", "--seva-frames", "12", "--seva-short-side", "64", "--device", "cpu"]
SECONDS_OF_SAMPLE = 0.05
GB = 1e9


class Failed(Exception):
    pass


def say(text):
    print(f"+ {text}", file=sys.stderr, flush=True)


def call(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode:
        raise Failed(f"{words[0]} {words[1]}: {(done.stderr.strip() or 'failed').splitlines()[-1]}")


# --- Random weights

def choices(braces):
    for item in braces.split(","):
        first, dash, last = item.partition("-")
        if dash and first.isdigit() and last.isdigit():
            yield from map(str, range(int(first), int(last) + 1))
        else:
            yield item


def names(pattern):
    """blocks.{0-2}.{weight,bias} -> its six names, as src/oraclegs/weights/parameter_list.h says."""
    before, brace, rest = pattern.partition("{")
    if not brace:
        return [pattern]
    braces, _, after = rest.partition("}")
    return [before + word + end for word in choices(braces) for end in names(after)]


def tensors_of(network):
    """{name: shape} of the tensors that the network reads."""
    tensors = {}
    for line in (LISTS / f"{network}.txt").read_text().splitlines():
        if line and line[0] not in "#?" and not line.startswith("ignore "):
            pattern, shape = line.split()
            for name in names(pattern):
                tensors[name] = [int(size) for size in shape.split("x")]
    return tensors


class Numbers:
    """Random float32 numbers as bytes. A block of them serves again and again, each time scaled by a power of two that
    the bits of the exponent give, for which no library is needed."""

    BYTES = 1 << 24

    def __init__(self, seed):
        import random

        self.random = int.from_bytes(random.Random(seed).randbytes(self.BYTES), "little")
        self.blocks = {}

    def block(self, exponent):
        """Numbers of either sign from 2^exponent to 2^(exponent + 1)."""
        if exponent not in self.blocks:
            keep = int.from_bytes(b"\xff\xff\x7f\x80" * (self.BYTES // 4), "little")
            power = int.from_bytes(((exponent + 127) << 23).to_bytes(4, "little") * (self.BYTES // 4), "little")
            self.blocks[exponent] = memoryview((self.random & keep | power).to_bytes(self.BYTES, "little"))
        return self.blocks[exponent]

    def write(self, file, count, exponent):
        block, left = self.block(exponent), 4 * count
        while left > 0:
            file.write(block[: min(left, self.BYTES)])
            left -= self.BYTES


def write_random(network, path, numbers):
    """Writes safetensors whose matrices keep the size of activations, whose scales are 1 and whose other vectors are 0."""
    tensors, header, at = tensors_of(network), {}, 0
    for name, shape in tensors.items():
        size = 4 * math.prod(shape)
        header[name] = {"dtype": "F32", "shape": shape, "data_offsets": [at, at + size]}
        at += size
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    with open(part, "wb") as file:
        file.write(len(text).to_bytes(8, "little") + text)
        for name, shape in tensors.items():
            if len(shape) > 1:
                root_mean_square = math.sqrt(7 / 3)  # of numbers from 1 to 2
                inputs = math.prod(shape[1:])
                numbers.write(file, math.prod(shape), round(math.log2(1 / (root_mean_square * math.sqrt(inputs)))))
            else:
                is_scale = name.endswith(("weight", "gamma"))
                file.write((b"\0\0\x80\x3f" if is_scale else bytes(4)) * shape[0])
    part.rename(path)


def make_weights(folder, small, bin_folder):
    if small:
        if not (folder / "seva/model.safetensors").exists():
            program = os.environ.get("ORACLEGS_TINY_NETWORKS", str(bin_folder / "tiny_networks"))
            call(program, folder)
        return
    numbers = None
    for network in NETWORKS:
        path = folder / network / "model.safetensors"
        if not path.exists():
            say(f"making {path}")
            numbers = numbers or Numbers(1)
            write_random(network, path, numbers)


# --- Stand-in scenes

def demo_scene(program, folder, views, size):
    shutil.rmtree(folder, ignore_errors=True)
    say(f"ray-tracing {views} images of {size[0]} x {size[1]}")
    call(program, "demo-scene", folder, "--demo-views", views, "--width", size[0], "--height", size[1], "--samples", 1, "--quiet")


def read_png(path):
    """Rows of an 8-bit RGB image."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        packed += data[at + 8 : at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    width, height = struct.unpack(">II", data[16:24])
    raw, rows, above = zlib.decompress(packed), [], bytes(3 * width)
    for y in range(height):
        begin = y * (3 * width + 1)
        above = unfiltered(raw[begin], raw[begin + 1 : begin + 1 + 3 * width], above)
        rows.append(above)
    return rows


def unfiltered(rule, line, above):
    """A row of a PNG without its filter; `above` is the one above it."""
    if rule == 0:
        return line
    if rule == 2:
        return bytes([(a + b) & 255 for a, b in zip(line, above, strict=True)])
    row = bytearray(3) + line  # three zeros stand to the left of it
    corners = bytes(3) + above
    for i, up in enumerate(above):
        left = row[i]
        if rule == 1:
            guess = left
        elif rule == 3:
            guess = left + up >> 1
        else:
            corner = corners[i]
            to_left, to_up, to_corner = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
            guess = left if to_left <= to_up and to_left <= to_corner else up if to_up <= to_corner else corner
        row[i + 3] = row[i + 3] + guess & 255
    return bytes(row[3:])


def write_png(path, rows, repeated):
    """Writes rows of RGB, each `repeated` times."""
    packer, width = zlib.compressobj(1), len(rows[0])
    same = (repeated - 1) * (b"\2" + bytes(width))  # as the row above
    packed = b"".join(packer.compress(b"\0" + row + same) for row in rows) + packer.flush()
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    header = struct.pack(">IIBBBBB", width // 3, repeated * len(rows), 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def write_enlarged(source, target):
    """Writes the image four times as large: each pixel as 4 x 4 equal ones."""
    rows = []
    for row in read_png(source):
        rows.append(bytearray(4 * len(row)))
        for k in range(12):
            rows[-1][k::12] = row[k % 3 :: 3]
    write_png(target, rows, 4)


def write_reduced(source, target):
    """Writes every fourth pixel of every fourth row."""
    rows = []
    for row in read_png(source)[::4]:
        rows.append(bytearray(len(row) // 4))
        for k in range(3):
            rows[-1][k::3] = row[k::12]
    write_png(target, rows, 1)


def world_to_camera(m):
    """Quaternion (w, x, y, z) and translation as COLMAP has them, of a camera-to-world matrix with OpenGL axes."""
    r = [[m[j][i] * (1 if i == 0 else -1) for j in range(3)] for i in range(3)]
    translation = [-sum(r[i][j] * m[j][3] for j in range(3)) for i in range(3)]
    w = math.sqrt(max(0, 1 + r[0][0] + r[1][1] + r[2][2])) / 2
    x = math.copysign(math.sqrt(max(0, 1 + r[0][0] - r[1][1] - r[2][2])) / 2, r[2][1] - r[1][2])
    y = math.copysign(math.sqrt(max(0, 1 - r[0][0] + r[1][1] - r[2][2])) / 2, r[0][2] - r[2][0])
    z = math.copysign(math.sqrt(max(0, 1 - r[0][0] - r[1][1] + r[2][2])) / 2, r[1][0] - r[0][1])
    return [w, x, y, z, *translation]


def make_mipnerf360(program, scene, views, size):
    """COLMAP's model of images/ beside images_4/ of this size: small images are made large and reduced, others enlarged,
    since tracing rays at their full size would take long."""
    demo, part, is_small = scene.with_suffix(".demo"), scene.with_suffix(".part"), size[0] < 200
    scale = 4 if is_small else 1
    demo_scene(program, demo, views, (scale * size[0], scale * size[1]))
    shutil.rmtree(part, ignore_errors=True)
    traced, made = [part / folder for folder in (("images", "images_4") if is_small else ("images_4", "images"))]
    for folder in (made, part / "sparse/0"):
        folder.mkdir(parents=True)
    (demo / "images").rename(traced)
    with multiprocessing.Pool(len(os.sched_getaffinity(0))) as pool:
        files = [(image, made / image.name) for image in traced.iterdir()]
        pool.starmap(write_reduced if is_small else write_enlarged, files, chunksize=1)
    transforms, model = json.loads((demo / "transforms.json").read_text()), part / "sparse/0"
    numbers = [4 // scale * transforms[key] for key in ("w", "h", "fl_x", "fl_y", "cx", "cy")]
    (model / "cameras.txt").write_text(" ".join(map(str, [1, "PINHOLE", *numbers])) + "\n")
    lines = [" ".join(map(str, [i, *world_to_camera(frame["transform_matrix"]), 1, Path(frame["file_path"]).name])) + "\n\n"
             for i, frame in enumerate(transforms["frames"], 1)]  # fmt: skip
    (model / "images.txt").write_text("".join(lines))
    (model / "points3D.txt").write_text("")
    shutil.rmtree(demo)
    part.rename(scene)


def make_blender(program, scene, train, size):
    """The named training images among `train` ones, and the 25 test images that are scored."""
    demo, part = scene.with_suffix(".demo"), scene.with_suffix(".part")
    test = [8 * i for i in range(25)]
    demo_scene(program, demo, len(train) + len(test), size)
    shutil.rmtree(part, ignore_errors=True)
    transforms = json.loads((demo / "transforms.json").read_text())
    frames, step = transforms["frames"], (len(train) + len(test)) / len(test)
    held_out = {int(i * step) for i in range(len(test))}
    for split, numbers in (("train", train), ("test", test)):
        (part / split).mkdir(parents=True)
        chosen = []
        of_split = [frame for i, frame in enumerate(frames) if (i in held_out) == (split == "test")]
        for number, frame in zip(numbers, of_split, strict=True):
            (demo / frame["file_path"]).rename(part / split / f"r_{number}.png")
            chosen.append({"file_path": f"./{split}/r_{number}", "transform_matrix": frame["transform_matrix"]})
        angle = 2 * math.atan(transforms["w"] / (2 * transforms["fl_x"]))
        (part / f"transforms_{split}.json").write_text(json.dumps({"camera_angle_x": angle, "frames": chosen}))
    shutil.rmtree(demo)
    part.rename(scene)


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
    size = (64, 42) if small else (1237, 822)
    scene = options.out / f"scenes/mipnerf360_{options.images}_{size[0]}"
    if not scene.exists():
        make_mipnerf360(program, scene, options.images, size)
    views = int(preset.rpartition("-")[2])
    withheld = options.images - math.ceil(options.images / 8) - views
    return scene, f"{views} of {options.images} images of {size[0]}x{size[1]}, {withheld} withheld poses"


# --- Measuring

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
        self.process = subprocess.Popen(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
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
        page = os.sysconf("SC_PAGE_SIZE")
        while not self.ended.wait(SECONDS_OF_SAMPLE):
            stage = self.now
            if stage is None:
                continue
            try:
                resident = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1]) * page
            except (OSError, IndexError):
                continue
            stage.host = max(stage.host, resident)
            if (used := self.gpu.bytes()) is not None:
                stage.device = max(stage.device or 0, used)


def full_seconds(stage, done, whole):
    """What the stage would take with `whole` steps in the place of `done`, from the time between its reports."""
    steps = [(b[0] - a[0]) / (b[1] - a[1]) for a, b in zip(stage.counts, stage.counts[1:], strict=False) if b[1] > a[1]]
    if done == whole or stage.seconds is None:
        return stage.seconds
    if not steps:  # too short for a report
        return stage.seconds * whole / done
    total = stage.counts[-1][2]
    return stage.seconds + statistics.median(steps) * total * (whole / done - 1)


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
- *memory*: largest resident memory of the process during the stage, with the pages of weights that are mapped.
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
    parser = argparse.ArgumentParser(prog="paper_rehearsal.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for weights, scenes, runs and the tables")
    parser.add_argument("--preset", action="append", choices=PRESETS, help="this one alone; may be given again")
    parser.add_argument("--models", type=Path, help="folder with the real weights, as $ORACLEGS_MODELS")
    parser.add_argument("--images", type=int, help="images of the stand-in for Mip-NeRF 360: 125 as stump has (default), up to 311 as room has")
    parser.add_argument("--steps", type=int, help="denoising steps of SEVA; time is extrapolated to 50")
    parser.add_argument("--iterations", type=int, help="iterations of the training; time is extrapolated to the preset's")
    parser.add_argument("--small", action="store_true", help="tiny networks and scenes, on the CPU")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of the built program")
    parser.add_argument("more", nargs="*", metavar="-- OPTIONS", help="further options of reconstruct")
    options = parser.parse_args()
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
            text = "\n".join(["# Rehearsal of the paper's presets", "", machine(gpu, weights), "", *lines]) + NOTES
            (options.out / "rehearsal.md").write_text(text)
            if run.stopped:
                break
    except (Failed, OSError) as error:
        sys.exit(f"paper_rehearsal.sh: {error}")
    print(text, end="")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

"""Stand-ins for what the rehearsal of the paper's presets needs and may not have: weights, and scenes (paper_rehearsal.py)."""

import json
import math
import multiprocessing
import os
import random
import shutil
import signal
import struct
import subprocess
import sys
import zlib
from pathlib import Path

LISTS = Path(__file__).resolve().parent.parent / "src/oraclegs/weights/lists"
NETWORKS = ["depth-anything-v2-small", "seva", "sd21-vae", "openclip-vith14", "vggt", "lpips-vgg"]
TRAIN_8 = [26, 86, 2, 55, 75, 93, 16, 73]  # of paper-blender-8


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
    with multiprocessing.Pool(len(os.sched_getaffinity(0)), signal.signal, (signal.SIGTERM, signal.SIG_DFL)) as pool:
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

#!/usr/bin/env python3
"""A generator for OracleGS: the demo program of Stability AI's Stable Virtual Camera.

usage: run.py REQUEST ANSWER --repo stable-virtual-camera [--python PYTHON] [OPTIONS OF demo.py]

REQUEST and ANSWER are the two folders of docs/generators.md. Runs in the Python environment of the demo, which has
Pillow. The demo gets our photos as input views and our poses as target views, in a scene folder of its own format.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SHORT_SIDE = 576  # pixels that the network was trained with
STRIDE = 64  # which both sides are multiples of
FRAMES = 21  # of one pass of the network: inputs and targets together
MIN_TARGETS = 9  # of a pass, where there are many inputs
MAX_SHAPE_DIFFERENCE = 1.1  # between a photo and the proposals


def size_of_network(width, height):
    """(width, height) with the short side of the network, and nearly the shape that is given."""
    scale = SHORT_SIDE / min(width, height)
    return tuple(max(STRIDE, STRIDE * round(side * scale / STRIDE)) for side in (width, height))


def resized(frame, size, file_path):
    """The frame for its image at another size."""
    x, y = size[0] / frame["w"], size[1] / frame["h"]
    return {
        "file_path": file_path,
        "w": size[0], "h": size[1],
        "fl_x": frame["fl_x"] * x, "cx": frame["cx"] * x,
        "fl_y": frame["fl_y"] * y, "cy": frame["cy"] * y,
        "transform_matrix": frame["transform_matrix"],
    }  # fmt: skip


def has_shape(frame, size):
    ratio = frame["w"] * size[1] / (frame["h"] * size[0])
    return 1 / MAX_SHAPE_DIFFERENCE < ratio < MAX_SHAPE_DIFFERENCE


def read_frames(folder):
    return json.loads((folder / "transforms.json").read_text())["frames"]


def write_scene(request, scene, size):
    """Writes the demo's scene folder: inputs first, then targets. Returns (number of inputs, target frames)."""
    from PIL import Image

    inputs = [frame for frame in read_frames(request / "images") if has_shape(frame, size)]
    targets = read_frames(request)
    if not inputs:
        sys.exit("run.py: no photo has the shape of the proposals")
    (scene / "images").mkdir(parents=True)
    frames = []
    for number, frame in enumerate(inputs):
        path = f"images/{number:03d}.png"
        Image.open(request / "images" / frame["file_path"]).convert("RGB").resize(size, Image.LANCZOS).save(scene / path)
        frames.append(resized(frame, size, path))
    for number, frame in enumerate(targets, len(inputs)):
        path = f"images/{number:03d}.png"  # a placeholder
        Image.new("RGB", size).save(scene / path)
        frames.append(resized(frame, size, path))
    (scene / "transforms.json").write_text(json.dumps({"frames": frames}))
    split = {"train_ids": list(range(len(inputs))), "test_ids": list(range(len(inputs), len(frames)))}
    (scene / f"train_test_split_{len(inputs)}.json").write_text(json.dumps(split))
    return len(inputs), targets


def demo_command(options, data, size, inputs):
    """img2img: target views in any order. Its pass has room for all inputs and some targets."""
    return [
        options.python, str(options.repo.resolve() / "demo.py"),
        "--data_path", str(data), "--data_items", "scene", "--task", "img2img", "--num_inputs", str(inputs),
        "--W", str(size[0]), "--H", str(size[1]), "--T", str(max(FRAMES, inputs + MIN_TARGETS)),
        "--num_input_semi_dense", str(inputs + 1), "--video_save_fps", "10", *options.more,
    ]  # fmt: skip


def read_answers(samples, answer, targets):
    """The demo's images, in the order of the targets, at the size that was asked for."""
    from PIL import Image

    images = sorted(samples.glob("*.png"))
    if len(images) != len(targets):
        sys.exit(f"run.py: {samples} has {len(images)} images of {len(targets)}")
    for image, frame in zip(images, targets):
        made = Image.open(image).convert("RGB").resize((frame["w"], frame["h"]), Image.LANCZOS)
        part = answer / (frame["file_path"] + ".part")
        made.save(part, format="PNG")
        part.rename(answer / frame["file_path"])


def main():
    parser = argparse.ArgumentParser(description="Stable Virtual Camera's demo program as a generator for OracleGS; options that it does not know go to demo.py")
    parser.add_argument("request", type=Path)
    parser.add_argument("answer", type=Path)
    parser.add_argument("--repo", type=Path, required=True, help="checkout of stable-virtual-camera")
    parser.add_argument("--python", default=sys.executable, help="Python that has the demo's packages")
    options, more = parser.parse_known_args()
    options.more = more
    if not (options.repo / "demo.py").is_file():
        sys.exit(f"run.py: {options.repo} has no demo.py; name the checkout of stable-virtual-camera with --repo")
    first = read_frames(options.request)[0]
    size = size_of_network(first["w"], first["h"])
    with tempfile.TemporaryDirectory(prefix="seva_demo_") as folder:
        data = Path(folder) / "data"
        inputs, targets = write_scene(options.request, data / "scene", size)
        # It writes below its working directory.
        done = subprocess.run(demo_command(options, data, size, inputs), cwd=folder, check=False)
        if done.returncode != 0:
            sys.exit(done.returncode)
        read_answers(Path(folder) / "work_dirs/demo/img2img/scene/samples-rgb", options.answer, targets)


if __name__ == "__main__":
    main()

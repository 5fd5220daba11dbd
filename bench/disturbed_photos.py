#!/usr/bin/env python3
"""Measures what photos cost that were exposed differently, and prints a Markdown table.

Each training photo of a scene gets another exposure, up to 1 EV more or less, and another white balance, up to 12 % more red and
less blue or the reverse, both drawn with the seed and applied to linear colors; with --vignette its corners darken by 20 %, too.
Test photos stay as they are, and scores are color-corrected: what is measured is shape, not a common tint. Scenes and runs are
kept in OUT_FOLDER. Needs ffmpeg and numpy (Debian: python3-numpy).

  bench/disturbed_photos.py DATA OUT                              # fox, room, mic, seed 7
  bench/disturbed_photos.py DATA OUT --scenes fox --vignette --options "--proposers none"
"""

import argparse
import json
import random
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

BIN = Path(__file__).resolve().parent.parent / "build/release/bin/oraclegs"
SCENES = {
    "fox": ["--test-every", 8, "--views", 12, "--downscale", 4],
    "room": ["--test-every", 8, "--views", 12, "--downscale", 4],
    "mic": ["--background", "white", "--downscale", 2],
}
EV, TINT, VIGNETTE = 1, 0.12, 0.2


def output_of(*words, **options):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, **options).stdout


def expose(path, factors, vignette):
    """Multiplies a photo's linear colors, in place; alpha stays."""
    probe = output_of("ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries", "stream=width,height,pix_fmt", "-of", "json", path)
    stream = json.loads(probe)["streams"][0]
    width, height, layout = stream["width"], stream["height"], "rgba" if "rgba" in stream["pix_fmt"] else "rgb24"
    raw = output_of("ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", layout, "-")
    pixels = np.frombuffer(raw, np.uint8).reshape(height, width, -1).copy()
    color = pixels[..., :3] / 255
    linear = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    linear = np.clip(linear * factors * (1 - vignette * (x**2 + y**2) / 2)[..., None], 0, 1)
    color = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    pixels[..., :3] = np.round(255 * color)
    jpeg = ["-q:v", 1, "-pix_fmt", "yuvj444p"] if path.suffix.lower() in (".jpg", ".jpeg") else []
    frame = ["-f", "rawvideo", "-pix_fmt", layout, "-s", f"{width}x{height}", "-i", "-"]
    output_of("ffmpeg", "-v", "error", "-y", *frame, *jpeg, path, input=pixels.tobytes())


def disturb(scene, names, seed, vignette):
    """Exposes the photos of these names anew."""
    draw = random.Random(seed)
    for name in sorted(names):
        ev, tint = draw.uniform(-EV, EV), draw.uniform(-TINT, TINT)
        photos = [p for p in scene.rglob("*") if p.suffix and str(p.with_suffix("")).endswith(f"/{Path(name).with_suffix('')}")]
        if not photos:
            sys.exit(f"{scene}: has no photo {name}")
        for photo in photos:
            expose(photo, 2**ev * np.array([1 + tint, 1, 1 - tint]), vignette)


def reconstruct(scene, run, options):
    """The scores of a run's test views."""
    words = ["reconstruct", scene, "-o", run, *options, "--no-report", "-q"]
    print("+ oraclegs", *words, file=sys.stderr, flush=True)
    output_of(BIN, *words)
    return json.loads((run / "metrics.json").read_text())["test"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path, metavar="DATA")
    parser.add_argument("out", type=Path, metavar="OUT_FOLDER")
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--vignette", action="store_true")
    parser.add_argument("--options", default="--iterations 1240 --proposers none", help="of each run")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    print("| scene | as taken | disturbed | difference |\n| --- | --- | --- | --- |")
    for name in given.scenes.split(","):
        options = [*SCENES[name], *shlex.split(given.options)]
        run = given.out / f"{name}_as_taken"
        plain = reconstruct(given.data / name, run, options)
        scene = given.out / f"{name}_{given.seed}{'_vignette' if given.vignette else ''}"
        if not scene.exists():
            copy = scene.with_name(scene.name + ".part")
            shutil.rmtree(copy, ignore_errors=True)
            shutil.copytree(given.data / name, copy)
            disturb(copy, json.loads((run / "split.json").read_text())["train"], given.seed, VIGNETTE if given.vignette else 0)
            copy.rename(scene)
        other = reconstruct(scene, scene.with_name(scene.name + "_run"), options)
        before, after = plain["psnr_color_corrected"], other["psnr_color_corrected"]
        print(f"| {name} | {before:.2f} | {after:.2f} | {after - before:+.2f} |", flush=True)


if __name__ == "__main__":
    main()

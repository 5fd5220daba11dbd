#!/usr/bin/env python3
"""Measures what refinement of poses regains, and prints a Markdown table.

The training cameras of a scene are turned by 0.3 degrees and moved by 1 % of their mean distance from their center, in
directions drawn with the seed; test cameras keep their true poses. Three runs: with true poses, with disturbed ones as
they are, with disturbed ones refined. A fourth refines true poses. A model may lie anywhere, so the test cameras go with it:
by the similarity under which the true training cameras see the points of stereo where those of the run see them. Each
run is kept in OUT_FOLDER. Needs numpy (Debian: python3-numpy).

  bench/disturbed_poses.py DATA OUT                               # fox, room, fern, mic, seed 0
  bench/disturbed_poses.py DATA OUT --scenes fox --seeds 0,1,2 --options "--iterations 1000"
"""

import argparse
import json
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

BIN = Path(__file__).resolve().parent.parent / "build/release/bin/oraclegs"
DEGREES, SHARE = 0.3, 0.01
SCENES = {  # options of the split, of the images
    "fox": (["--test-every", 8, "--views", 12], ["--max-size", 280]),
    "room": (["--test-every", 8, "--views", 12], ["--max-size", 320]),
    "fern": (["--test-every", 8, "--views", 6], ["--max-size", 400]),
    "mic": ([], ["--max-size", 250, "--background", "white"]),
}
RUNS = {  # is the input disturbed; options
    "true": (False, ["--refine-poses", "off"]),
    "off": (True, ["--refine-poses", "off"]),
    "refined": (True, []),
    "good": (False, []),
}


def oraclegs(*words):
    print("+ oraclegs", *words, file=sys.stderr, flush=True)
    ran = subprocess.run([str(BIN), *map(str, words)], capture_output=True, text=True)
    if ran.returncode:
        sys.exit(f"oraclegs failed: {ran.stderr.splitlines()[-1] if ran.stderr else ran.returncode}")


def turn(vector):
    """Rotation by a vector's length about it."""
    angle = np.linalg.norm(vector)
    if angle < 1e-15:
        return np.eye(3)
    x, y, z = vector / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


class Dataset:
    """A folder with transforms.json, or with a file for training and one for testing (Blender)."""

    def __init__(self, root):
        self.root = Path(root)
        names = ["transforms_train.json", "transforms_test.json"]
        self.names = names if (self.root / names[0]).exists() else ["transforms.json"]
        self.files = [json.loads((self.root / name).read_text()) for name in self.names]
        for file in self.files:
            file["frames"].sort(key=lambda frame: frame["file_path"])

    def frames(self, test):
        if len(self.files) == 2:
            return self.files[test]["frames"]
        return [frame for i, frame in enumerate(self.files[0]["frames"]) if (i % 8 == 0) == test]

    def poses(self):
        """{stem: camera to world} of the cameras that train."""
        return {Path(f["file_path"]).stem: np.array(f["transform_matrix"], float) for f in self.frames(False)}

    def write(self, out):
        """A copy, with the poses as they are now."""
        for entry in self.root.iterdir():
            if entry.is_dir() and entry.name != "sparse" and not (out / entry.name).exists():
                shutil.copytree(entry, out / entry.name)
        out.mkdir(exist_ok=True)
        for name, file in zip(self.names, self.files):
            (out / name).write_text(json.dumps(file))


def disturb(dataset, seed):
    random = np.random.default_rng(seed)
    frames = dataset.frames(False)
    centers = np.array([np.array(f["transform_matrix"])[:3, 3] for f in frames])
    extent = np.linalg.norm(centers - centers.mean(0), axis=1).mean()
    direction = lambda: (v := random.normal(size=3)) / np.linalg.norm(v)
    for frame in frames:
        pose = np.array(frame["transform_matrix"], float)
        pose[:3, :3] = turn(np.radians(DEGREES) * direction()) @ pose[:3, :3]
        pose[:3, 3] += SHARE * extent * direction()
        frame["transform_matrix"] = pose.tolist()


def used_poses(run, dataset):
    """{stem: camera to world} of the cameras that a run trained with, in the dataset's coordinates."""
    poses = dataset.poses()
    refined = run / "sfm/refined.json"
    if refined.exists():
        frame = json.loads((run / "frame.json").read_text())
        for name, numbers in json.loads(refined.read_text())["cam_from_world"].items():
            cam_from_world, pose = np.reshape(numbers, (3, 4)), np.eye(4)
            rotation = cam_from_world[:, :3]
            pose[:3, :3] = rotation.T @ np.diag([1, -1, -1])
            pose[:3, 3] = -rotation.T @ cam_from_world[:, 3] / frame["scale"] + frame["center"]
            poses[Path(name).stem] = pose
    return [poses[Path(name).stem] for name in json.loads((run / "split.json").read_text())["train"]]


def dense_points(run):
    raw = (run / "sfm/dense.ply").read_bytes()
    end = raw.index(b"end_header\n") + len(b"end_header\n")
    header = raw[:end].decode().splitlines()
    kinds = {"float": "<f4", "uchar": "u1"}
    fields = [(line.split()[2], kinds[line.split()[1]]) for line in header if line.startswith("property")]
    points = np.frombuffer(raw[end:], dtype=fields)
    order = np.random.default_rng(0).permutation(len(points))[:4000]
    return np.stack([points[axis][order] for axis in "xyz"], 1).astype(float)


def similarity(true, used, points):
    """Rotation, scale and translation that bring true cameras to where they see the points as the used ones do."""
    seen = []
    for pose in used:
        local = (points - pose[:3, 3]) @ pose[:3, :3]
        ahead = (-local[:, 2] > 0) & (np.hypot(local[:, 0], local[:, 1]) < 0.4 * -local[:, 2])
        seen.append(points[ahead][:300])
    pivot = np.concatenate(seen).mean(0)
    left, _, right = np.linalg.svd(sum(b[:3, :3] @ a[:3, :3].T for a, b in zip(true, used)))
    rotation = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    a, b = np.array([p[:3, 3] for p in true]) @ rotation.T, np.array([p[:3, 3] for p in used])
    scale = ((a - a.mean(0)) * (b - b.mean(0))).sum() / ((a - a.mean(0)) ** 2).sum()
    found = rotation, scale, b.mean(0) - scale * a.mean(0)
    extent = np.linalg.norm(b - b.mean(0), axis=1).mean()

    def misses(rotation, scale, translation):
        rows = []
        for pose, target, points in zip(true, used, seen):
            moved = (points - scale * rotation @ pose[:3, 3] - translation) @ rotation @ pose[:3, :3]
            local = (points - target[:3, 3]) @ target[:3, :3]
            rows.append((moved[:, :2] / moved[:, 2:] - local[:, :2] / local[:, 2:]).ravel() / np.sqrt(len(points)))
        return np.concatenate(rows)

    def stepped(rotation, scale, translation, step):
        by, factor = turn(step[:3]), np.exp(step[6])
        return by @ rotation, scale * factor, factor * by @ (translation - pivot) + pivot + extent * step[3:6]

    for _ in range(20):
        now, small = misses(*found), 1e-6
        slopes = [(misses(*stepped(*found, small * row)) - now) / small for row in np.eye(7)]
        found = stepped(*found, -np.linalg.lstsq(np.stack(slopes, 1), now, rcond=None)[0])
    return found


def score(run, given, true, images):
    """PSNR of the test views, whose true cameras go with the model."""
    moved = Dataset(true)
    cameras, names = moved.poses(), json.loads((run / "split.json").read_text())["train"]
    rotation, scale, translation = similarity(
        [cameras[Path(name).stem] for name in names], used_poses(run, Dataset(given)), dense_points(run)
    )
    for frame in moved.frames(True):
        pose = np.array(frame["transform_matrix"], float)
        pose[:3, :3] = rotation @ pose[:3, :3]
        pose[:3, 3] = scale * rotation @ pose[:3, 3] + translation
        frame["transform_matrix"] = pose.tolist()
    scene = run.with_name(run.name + "_test")
    moved.write(scene)
    split = [] if len(moved.files) == 2 else ["--test-every", 8]
    scores = run.with_name(run.name + "_scores")
    oraclegs("evaluate", scene, "--ply", run / "point_cloud.ply", "-o", scores, *split, *images, "-q")
    return json.loads((scores / "metrics.json").read_text())["test"]["psnr"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path, metavar="DATA")
    parser.add_argument("out", type=Path, metavar="OUT_FOLDER")
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--seeds", default="0")
    parser.add_argument("--options", default="--iterations 1000 --proposers none", help="of each run")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    print("| scene, seed | off by, px | refined to, px | true | off | refined | regained | true, refined |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for name in given.scenes.split(","):
        split, images = SCENES[name]
        true = given.data / name
        if not list(true.glob("transforms*.json")):
            true = given.out / f"{name}_cameras"
            if not true.exists():
                oraclegs("cameras", given.data / name, "-o", true, "--downscale", 4, "-q")
        for seed in map(int, given.seeds.split(",")):
            disturbed = given.out / f"{name}_{seed}"
            dataset = Dataset(true)
            disturb(dataset, seed)
            disturbed.mkdir(exist_ok=True)
            dataset.write(disturbed)
            psnr, poses = {}, {}
            for kind, (is_disturbed, own) in RUNS.items():
                run, scene = given.out / f"{name}_{seed}_{kind}", disturbed if is_disturbed else true
                rest = [*split, *images, *shlex.split(given.options), "--seed", seed, *own]
                oraclegs("reconstruct", scene, "-o", run, *rest, "--no-report", "-q")
                psnr[kind] = score(run, scene, true, images)
                poses[kind] = json.loads((run / "metrics.json").read_text()).get("poses", {})
            regained = (psnr["refined"] - psnr["off"]) / (psnr["true"] - psnr["off"])
            found = poses["refined"]
            print(
                f"| {name}, {seed} | {found.get('before', 0):.2f} | {found.get('after', 0):.2f} | {psnr['true']:.2f} | "
                f"{psnr['off']:.2f} | {psnr['refined']:.2f} | {100 * regained:.0f} % | "
                f"{psnr['good']:.2f}, {poses['good'].get('result')} |",
                flush=True,
            )


if __name__ == "__main__":
    main()

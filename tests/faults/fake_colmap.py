#!/usr/bin/env python3
"""A stand-in for colmap that is quick, and makes the same bits of the same photos each time: it knows the poses.

FAKE_COLMAP_SCENE    the scene with transforms.json that the photos were taken from
FAKE_COLMAP_SECONDS  how long each command takes
FAKE_COLMAP_FAULT    COMMAND:FAULT, what goes wrong in a command (or in any, *): hang, fail, crash, killed, rubbish,
                     nothing, full, memory
"""

import json
import os
import random
import signal
import sqlite3
import struct
import subprocess
import sys
import time
from pathlib import Path

PAIR_BASE = 2147483647
SIMPLE_RADIAL = 2
POINTS = 400


def size_of(path):
    return struct.unpack(">II", path.read_bytes()[16:24])


def read_poses():
    """{stem of the photo: (focal length in widths, rotation rows, translation)}, camera from world, z forward."""
    transforms = json.loads((Path(os.environ["FAKE_COLMAP_SCENE"]) / "transforms.json").read_text())
    poses = {}
    for frame in transforms["frames"]:
        both = {**transforms, **frame}
        matrix = frame["transform_matrix"]
        axes = [[sign * matrix[row][column] for row in range(3)] for column, sign in enumerate((1, -1, -1))]
        center = [matrix[row][3] for row in range(3)]
        translation = [-sum(axis[i] * center[i] for i in range(3)) for axis in axes]
        poses[Path(frame["file_path"]).stem] = (both["fl_x"] / both["w"], axes, translation)
    return poses


def quaternion(rows):
    """(w, x, y, z) of a rotation."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    candidates = [(1 + a + e + i, (lambda s: (s / 2, (h - f) / (2 * s), (c - g) / (2 * s), (d - b) / (2 * s)))),
                  (1 + a - e - i, (lambda s: ((h - f) / (2 * s), s / 2, (b + d) / (2 * s), (c + g) / (2 * s)))),
                  (1 - a + e - i, (lambda s: ((c - g) / (2 * s), (b + d) / (2 * s), s / 2, (f + h) / (2 * s)))),
                  (1 - a - e + i, (lambda s: ((d - b) / (2 * s), (c + g) / (2 * s), (f + h) / (2 * s), s / 2)))]  # fmt: skip
    square, make = max(candidates, key=lambda candidate: candidate[0])
    return make(square**0.5)


def extract_features(database, image_path):
    database.executescript(
        "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY, model INTEGER, width INTEGER, height INTEGER,"
        " params BLOB, prior_focal_length INTEGER);"
        "CREATE TABLE images (image_id INTEGER PRIMARY KEY, name TEXT, camera_id INTEGER);"
        "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);"
        "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);"
        "CREATE TABLE matches (pair_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB);"
        "CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data BLOB,"
        " config INTEGER, F BLOB, E BLOB, H BLOB);"
    )
    cameras = {}
    names = sorted(str(path.relative_to(image_path)) for path in image_path.rglob("*.*"))
    for number, name in enumerate(names, 1):
        print(f"Processed file [{number}/{len(names)}]", flush=True)
        folder = str(Path(name).parent)
        if folder not in cameras:
            cameras[folder] = len(cameras) + 1
            width, height = size_of(image_path / name)
            params = struct.pack("<4d", 1.2 * width, width / 2, height / 2, 0)
            database.execute("INSERT INTO cameras VALUES (?, ?, ?, ?, ?, 0)",
                             (cameras[folder], SIMPLE_RADIAL, width, height, params))  # fmt: skip
        database.execute("INSERT INTO images VALUES (?, ?, ?)", (number, name, cameras[folder]))
        keypoints = struct.pack("<600f", *[0.5 * i for i in range(600)])
        database.execute("INSERT INTO keypoints VALUES (?, 100, 6, ?)", (number, keypoints))
        database.execute("INSERT INTO descriptors VALUES (?, 100, 128, ?)", (number, bytes(12800)))


def match(database):
    """Pairs that are there already stay, as with colmap after a kill."""
    ids = [row[0] for row in database.execute("SELECT image_id FROM images ORDER BY image_id")]
    print("Matching block [1/1, 1/1]", flush=True)
    pairs = struct.pack("<200I", *[i // 2 for i in range(200)])
    for a in ids:
        for b in ids:
            if a < b:
                pair = PAIR_BASE * a + b
                database.execute("INSERT OR IGNORE INTO matches VALUES (?, 100, 2, ?)", (pair, pairs))
                database.execute("INSERT OR IGNORE INTO two_view_geometries VALUES (?, 100, 2, ?, 3, NULL, NULL, NULL)",
                                 (pair, pairs))  # fmt: skip


def write_model(database, image_path, out):
    """The true poses, and points on three spheres about the middle, seen wherever they fall into a photo."""
    out.mkdir(parents=True, exist_ok=True)
    poses, images, cameras = read_poses(), [], {}
    for number, name, camera in database.execute("SELECT image_id, name, camera_id FROM images ORDER BY image_id"):
        print(f"Registering image #{number} ({len(images) + 1})", flush=True)
        real = (image_path / name).resolve()
        focal, rows, translation = poses[real.stem]
        width, height = size_of(real)
        cameras[camera] = (width, height, focal * width)
        images.append((number, name, camera, rows, translation))
    numbers, points = random.Random(7), []
    for index in range(POINTS):
        direction = [numbers.gauss(0, 1) for _ in range(3)]
        length = sum(x * x for x in direction) ** 0.5
        xyz = [(0.3, 0.6, 0.9)[index % 3] * x / length for x in direction]
        track = []
        for number, _, camera, rows, translation in images:
            x, y, z = (sum(row[i] * xyz[i] for i in range(3)) + t for row, t in zip(rows, translation))
            width, height, focal = cameras[camera]
            if z > 0.1 and abs(x / z * focal) < width / 2 and abs(y / z * focal) < height / 2:
                track.append(number)
        if len(track) > 1:
            points.append((xyz, track))
    (out / "cameras.txt").write_text("".join(
        f"{camera} SIMPLE_RADIAL {w} {h} {focal!r} {w / 2} {h / 2} 0\n" for camera, (w, h, focal) in cameras.items()))  # fmt: skip
    (out / "images.txt").write_text("".join(
        " ".join(map(repr, [number, *quaternion(rows), *translation])) + f" {camera} {name}\n\n"
        for number, name, camera, rows, translation in images))  # fmt: skip
    (out / "points3D.txt").write_text("".join(
        " ".join(map(repr, [i, *xyz])) + " 120 110 100 0.5 " + " ".join(f"{number} 0" for number in track) + "\n"
        for i, (xyz, track) in enumerate(points, 1)))  # fmt: skip


def go_wrong(fault, options):
    """False for the faults after which the command is done all the same."""
    database = options.get("database_path")
    if fault == "hang":
        time.sleep(3600)
    elif fault == "fail":
        print("F20261122 08:06:59.9 1 sfm.cc:473] it does not work out", file=sys.stderr)
    elif fault == "full":
        print("SQLite error: database or disk is full", file=sys.stderr)
    elif fault == "memory":
        print("terminate called after throwing an instance of 'std::bad_alloc'\n  what():  std::bad_alloc",
              file=sys.stderr, flush=True)  # fmt: skip
        os.kill(os.getpid(), signal.SIGABRT)
    elif fault in ("crash", "killed"):
        os.kill(os.getpid(), signal.SIGSEGV if fault == "crash" else signal.SIGKILL)
    elif fault == "rubbish":
        print("\0\x1b[31m\a" + "x" * 200_000, flush=True)
        if database:
            Path(database).write_bytes(b"no database" * 1000)
        if "output_path" in options:
            for name in ("cameras.bin", "images.bin", "points3D.bin"):
                model = Path(options["output_path"])
                model = model / "0" if sys.argv[1] == "mapper" else model
                model.mkdir(parents=True, exist_ok=True)
                (model / name).write_bytes(os.urandom(500))
        sys.exit(0)
    elif fault == "nothing":
        sys.exit(0)
    sys.exit(1)


def main():
    command, words = sys.argv[1], sys.argv[2:]
    options = {words[i][2:]: words[i + 1] for i in range(0, len(words) - 1, 2)}
    if not os.environ.get("FAKE_COLMAP_ALONE"):
        helper = subprocess.Popen(["sleep", "60"])  # colmap has threads; others have children, which must not stay
    where, _, fault = os.environ.get("FAKE_COLMAP_FAULT", "").partition(":")
    if fault and where in ("*", command):
        go_wrong(fault, options)
    time.sleep(float(os.environ.get("FAKE_COLMAP_SECONDS", "0")) / 2)
    images = Path(options.get("image_path", "."))
    with sqlite3.connect(options["database_path"]) as database:
        if command == "feature_extractor":
            extract_features(database, images)
        elif command in ("exhaustive_matcher", "matches_importer"):
            match(database)
        elif command == "mapper":
            write_model(database, images, Path(options["output_path"]) / "0")
        elif command == "point_triangulator":
            write_model(database, images, Path(options["output_path"]))
        else:
            sys.exit(f"no such command: {command}")
    database.close()
    time.sleep(float(os.environ.get("FAKE_COLMAP_SECONDS", "0")) / 2)
    if not os.environ.get("FAKE_COLMAP_ALONE"):
        helper.kill()
        helper.wait()


if __name__ == "__main__":
    main()

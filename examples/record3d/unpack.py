#!/usr/bin/env python3
"""Makes a scene with poses, depth and confidence of a capture of Record3D (README.md): unpack.py CAPTURE.r3d SCENE [EVERY]"""

import array
import json
import struct
import sys
import zipfile
import zlib
from pathlib import Path

try:
    import liblzfse
except ImportError:
    sys.exit("unpack.py: needs the package that unpacks Apple's LZFSE: pip install pyliblzfse")

MILLIMETERS = 1000
FARTHEST = 65534


def png(width, height, bits, rows):
    """A gray PNG; `rows` are big-endian bytes."""

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    stride = width * bits // 8
    lines = b"".join(b"\0" + rows[y * stride : (y + 1) * stride] for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def millimeters(packed):
    """Depth in meters as 32-bit floats becomes 16-bit millimeters, 0 = unknown."""
    meters = array.array("f", liblzfse.decompress(packed))
    if sys.byteorder == "big":
        meters.byteswap()
    levels = array.array("H", (round(m * MILLIMETERS) if 0 < m * MILLIMETERS < FARTHEST else 0 for m in meters))
    if sys.byteorder == "little":
        levels.byteswap()
    return levels.tobytes()


def matrix(pose):
    """Camera to world of [qx, qy, qz, qw, x, y, z]."""
    x, y, z, w, *place = pose
    n = 2 / (x * x + y * y + z * z + w * w)
    rows = [[1 - n * (y * y + z * z), n * (x * y - z * w), n * (x * z + y * w)],
            [n * (x * y + z * w), 1 - n * (x * x + z * z), n * (y * z - x * w)],
            [n * (x * z - y * w), n * (y * z + x * w), 1 - n * (x * x + y * y)]]  # fmt: skip
    return [[*row, p] for row, p in zip(rows, place)] + [[0, 0, 0, 1]]


def sizes(count, known):
    """Width and height of a depth image of so many pixels."""
    for width, height in [known, (192, 256), (256, 192), (480, 640), (640, 480)]:
        if width * height == count:
            return width, height
    sys.exit(f"unpack.py: a depth image has {count} pixels, whose shape is not known")


def unpack(capture, scene, every):
    with zipfile.ZipFile(capture) as archive:
        names = set(archive.namelist())
        metadata = json.loads(archive.read("metadata" if "metadata" in names else "metadata.json"))
        k, frames = metadata["K"], []
        for folder in ("images", "depth", "confidence"):
            (scene / folder).mkdir(parents=True)
        for i, pose in list(enumerate(metadata["poses"]))[::every]:
            if f"rgbd/{i}.jpg" not in names:
                continue
            frame = {"file_path": f"images/{i:05}.jpg", "transform_matrix": matrix(pose)}
            (scene / frame["file_path"]).write_bytes(archive.read(f"rgbd/{i}.jpg"))
            if f"rgbd/{i}.depth" in names:
                depth = millimeters(archive.read(f"rgbd/{i}.depth"))
                width, height = sizes(len(depth) // 2, (metadata.get("dw", 0), metadata.get("dh", 0)))
                frame["depth_file_path"] = f"depth/{i:05}.png"
                (scene / frame["depth_file_path"]).write_bytes(png(width, height, 16, depth))
                if f"rgbd/{i}.conf" in names:
                    frame["confidence_file_path"] = f"confidence/{i:05}.png"
                    levels = liblzfse.decompress(archive.read(f"rgbd/{i}.conf"))  # 0 low, 1 medium, 2 high
                    (scene / frame["confidence_file_path"]).write_bytes(png(width, height, 8, levels))
            frames.append(frame)
    transforms = {"camera_model": "PINHOLE", "w": metadata["w"], "h": metadata["h"], "fl_x": k[0], "fl_y": k[4],
                  "cx": k[6], "cy": k[7], "frames": frames}  # fmt: skip
    (scene / "transforms.json").write_text(json.dumps(transforms, indent=1))
    print(f"{scene}: {len(frames)} frames, {sum('depth_file_path' in frame for frame in frames)} with depth")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    if Path(sys.argv[2]).exists():
        sys.exit(f"unpack.py: {sys.argv[2]} exists; name a new folder")
    unpack(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 1)

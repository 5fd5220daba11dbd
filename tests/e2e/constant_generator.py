"""A generator for tests: fills the holes of our warps with one color, or goes wrong on demand.

usage: constant_generator.py REQUEST ANSWER [slow | fail | hang | missing | size]
"""

import json
import struct
import sys
import time
import zlib
from pathlib import Path

COLOR = (10, 200, 30)


def read_png(path):
    """(width, height, rows) of an 8-bit gray or RGB PNG; a row is a bytearray."""
    data = path.read_bytes()
    position, packed = 8, b""
    while position < len(data):
        length, kind = struct.unpack(">I4s", data[position : position + 8])
        chunk = data[position + 8 : position + 8 + length]
        if kind == b"IHDR":
            width, height, _, color = struct.unpack(">IIBB", chunk[:10])
        packed += chunk if kind == b"IDAT" else b""
        position += length + 12
    channels = {0: 1, 2: 3}[color]
    raw, size = zlib.decompress(packed), width * channels
    rows, above = [], bytearray(size)
    for y in range(height):
        filtered = raw[y * (size + 1)]
        row = bytearray(raw[y * (size + 1) + 1 : (y + 1) * (size + 1)])
        for i in range(size):
            left = row[i - channels] if i >= channels else 0
            corner = above[i - channels] if i >= channels else 0
            p = left + above[i] - corner
            paeth = min((abs(p - v), k, v) for k, v in enumerate((left, above[i], corner)))[2]
            row[i] = (row[i] + (0, left, above[i], (left + above[i]) // 2, paeth)[filtered]) & 255
        rows.append(row)
        above = row
    return width, height, rows


def write_png(path, width, height, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packed = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def main(request, answer, fault=""):
    request, answer = Path(request), Path(answer)
    frames = json.loads((request / "transforms.json").read_text())["frames"]
    for number, frame in enumerate(frames):
        name = frame["file_path"]
        width, height, warp = read_png(request / "warps" / name)
        _, _, mask = read_png(request / "masks" / name)
        for y in range(height):
            for x in range(width):
                if mask[y][x] == 0:
                    warp[y][3 * x : 3 * x + 3] = bytes(COLOR)
        if number == 1 and fault == "fail":
            print("loading the network\nthe network has no memory", file=sys.stderr)
            return 7
        if number == 3 and fault == "slow":
            time.sleep(2)
        if number == 1 and fault == "hang":
            time.sleep(600)
        if number == 1 and fault == "missing":
            continue
        height -= number == 1 and fault == "size"
        write_png(answer / name, width, height, warp[:height])
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

"""Masks for OracleGS: keeps what stands before a plain backdrop. Python alone, no packages.

usage: mask.py REQUEST ANSWER [TOLERANCE]

REQUEST and ANSWER are the two folders of docs/formats.md#masks-by-a-command. The backdrop is what has the color of the photo's border, within
TOLERANCE of 255 in each channel (24), and is connected with the border.
"""

import os
import statistics
import struct
import sys
import zlib
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def unfiltered(rule, line, above, channels):
    """A row of a PNG without the prediction that its filter subtracted."""
    if rule == 2:
        return bytearray((value + up) & 255 for value, up in zip(line, above))
    for i in range(len(line) if rule else 0):
        left, corner = (line[i - channels], above[i - channels]) if i >= channels else (0, 0)
        if rule == 1:
            predicted = left
        elif rule == 3:
            predicted = (left + above[i]) // 2
        else:
            to_left, to_up, to_corner = abs(above[i] - corner), abs(left - corner), abs(left + above[i] - 2 * corner)
            predicted = left if to_left <= to_up and to_left <= to_corner else above[i] if to_up <= to_corner else corner
        line[i] = (line[i] + predicted) & 255
    return line


def read_png(path):
    """(width, height, channels, rows) of an 8-bit PNG as OracleGS writes it; a row is a bytearray."""
    data, at, packed = path.read_bytes(), len(SIGNATURE), b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        if kind == b"IHDR":
            width, height, _, color = struct.unpack(">IIBB", data[at + 8 : at + 18])
        if kind == b"IDAT":
            packed += data[at + 8 : at + 8 + length]
        at += length + 12
    channels = {0: 1, 2: 3, 6: 4}[color]
    raw, size, rows = zlib.decompress(packed), width * channels, []
    above = bytearray(size)
    for begin in range(0, height * (size + 1), size + 1):
        above = unfiltered(raw[begin], bytearray(raw[begin + 1 : begin + 1 + size]), above, channels)
        rows.append(above)
    return width, height, channels, rows


def write_gray(path, width, rows):
    """Under another name first: an image is counted as soon as it is there."""

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, len(rows), 8, 0, 0, 0, 0)
    packed = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    part = path.with_suffix(".part")
    part.write_bytes(SIGNATURE + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))
    os.replace(part, path)


def backdrop_color(rows, channels):
    """The median of each channel along the border."""
    return [
        statistics.median_low([*rows[0][c::channels], *rows[-1][c::channels], *(row[c] for row in rows),
                               *(row[c - channels] for row in rows)])
        for c in range(channels)
    ]  # fmt: skip


def object_mask(width, height, channels, rows, tolerance):
    """Rows of 255 = object, 0 = backdrop."""
    color = backdrop_color(rows, channels)
    mask = []
    for row in rows:
        differences = (max(abs(value - want) for value, want in zip(row[i : i + channels], color)) for i in range(0, len(row), channels))
        mask.append(bytearray(1 if difference <= tolerance else 255 for difference in differences))  # 1 = of that color
    open_pixels = [(x, y) for y in range(height) for x in (range(width) if y in (0, height - 1) else (0, width - 1))]
    while open_pixels:
        x, y = open_pixels.pop()
        if not (0 <= x < width and 0 <= y < height) or mask[y][x] != 1:
            continue
        mask[y][x] = 0
        open_pixels += [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)]
    return [row.replace(b"\1", b"\xff") for row in mask]


def mask_photo(photo, answer, tolerance):
    width, height, channels, rows = read_png(photo)
    write_gray(answer / photo.name, width, object_mask(width, height, channels, rows, tolerance))
    return photo.name


def main(request, answer, tolerance=24):
    photos = sorted(Path(request).glob("*.png"))
    with ProcessPoolExecutor() as pool:
        for name in pool.map(mask_photo, photos, [Path(answer)] * len(photos), [int(tolerance)] * len(photos)):
            print(name, flush=True)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__.split("\n\n")[1])
    main(*sys.argv[1:])

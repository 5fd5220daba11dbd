#!/usr/bin/env python3
"""Fills the disk at random places of every stage; with room again, the same command must end with the same bits.

usage: fill_disk.py [--places N] [--seed S] [--stages A,B] [--tmpfs]

A library (full_disk.cpp) lets writes below the output folder fail once a random number of bytes was written there, also
those of colmap and ffmpeg, in one of five ways. --tmpfs takes a small file system in memory instead, which needs root.
"""

import argparse
import errno
import os
import random
import shutil
import struct
import subprocess
import sys
import time
from pathlib import Path

from lab import ERROR, STAGES, Broken, Lab, error_of, require, results, table

LIBRARY = os.environ.get("ORACLEGS_FULL_DISK", str(Path(__file__).resolve().parents[2] / "build/release/tests/full_disk.so"))
WAYS = {
    "writes": {},
    "writes and names": {"FULL_DISK_NAMES": "1"},
    "flushing": {"FULL_DISK_LATE": "1"},
    "quota": {"FULL_DISK_ERRNO": str(errno.EDQUOT)},
    "quota and names": {"FULL_DISK_ERRNO": str(errno.EDQUOT), "FULL_DISK_NAMES": "1"},
}
PLENTY = 1 << 60


class Disk:
    """What the library is given, and what it reports."""

    def __init__(self, lab, folder):
        self.path, self.folder = lab.dir / "disk_state", folder

    def environment(self, room, way="writes"):
        self.path.write_bytes(struct.pack("<QQ", 0, room))
        return {"LD_PRELOAD": LIBRARY, "FULL_DISK_FOLDER": str(self.folder), "FULL_DISK_STATE": str(self.path), **WAYS[way]}

    def written(self):
        return struct.unpack("<QQ", self.path.read_bytes())[0]


class Filler:
    def __init__(self, lab, numbers):
        self.lab, self.numbers = lab, numbers
        self.out = lab.dir / "full"
        self.disk = Disk(lab, self.out)
        self.rows = {stage: {"places": 0, "ended": 0, "went on": 0, "same bits": 0} for stage in ["start", *STAGES]}
        self.reference, self.begins, self.ends = None, {}, {}

    def learn(self):
        run = self.lab.start(self.out, environment=self.disk.environment(PLENTY))
        for stage in STAGES:
            run.wait_for(stage)
            self.begins[stage] = self.disk.written()
        code, text = run.wait()
        require(code == 0, text)
        following = [*list(self.begins.values())[1:], self.disk.written()]
        self.ends = dict(zip(STAGES, following))
        require(following[-1] > 10000, f"{LIBRARY} counts nothing")
        self.reference = results(self.out)

    def check_ended(self, code, text):
        """A run that ended: one line that names a file there and says what to do."""
        require(code == 4, f"exit code {code}:\n{text}")
        line = error_of(text)
        require(str(self.out) in line, f"names no file of the output folder: {line}")
        require("make room" in line, f"does not say to make room: {line}")
        left = [str(path) for path in self.out.rglob("*.tmp")]
        require(not left, f"left: {left}")
        return line

    def fill(self, stage, verbose=False):
        """A place in this stage; the disk may be found to be full later."""
        shutil.rmtree(self.out, ignore_errors=True)
        way = self.numbers.choice(list(WAYS))
        room = self.numbers.randrange(self.begins[stage], max(self.ends[stage], self.begins[stage] + 1))
        run = self.lab.start(self.out, environment=self.disk.environment(room, way))
        try:
            self.check(run, stage, verbose, f"{room} bytes, {way}")
        except Broken as broken:
            raise Broken(f"{stage}, {room} bytes, {way}: {broken}") from None

    def check(self, run, stage, verbose, what):
        code, text = run.wait()
        row = self.rows[stage]
        row["places"] += 1
        row["went on" if code == 0 else "ended"] += 1
        if code != 0:
            line = self.check_ended(code, text)
            if verbose:
                print(f"{stage}, {what}: {line}", flush=True)
        else:
            require(ERROR not in text, text)
        self.lab.check_no_orphans()
        self.lab.check_surroundings()
        self.lab.check_records(self.out)
        self.lab.finish(self.out)
        self.lab.check_finished(self.out, self.reference)
        self.lab.check_surroundings()
        row["same bits"] += 1

    def fill_tmpfs(self, verbose=False):
        """The same with a real file system, of a random size."""
        self.out = self.lab.dir / "mount" / "full"
        mount = self.out.parent
        mount.mkdir(exist_ok=True)
        stage = self.numbers.choice(STAGES)
        kilobytes = self.numbers.randrange(self.begins[stage], self.ends[stage] + 1) // 1024 + 8
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", mount], check=True)
        try:
            code, text = self.lab.start(self.out).wait()
            if code != 0:
                line = self.check_ended(code, text)
                if verbose:
                    print(f"{kilobytes} kB: {line}", flush=True)
            self.lab.check_no_orphans()
            subprocess.run(["mount", "-o", "remount,size=100m", mount], check=True)
            self.lab.finish(self.out)
            self.lab.check_finished(self.out, self.reference)
            return code
        except Broken as broken:
            raise Broken(f"{kilobytes} kB: {broken}") from None
        finally:
            subprocess.run(["umount", mount], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--places", type=int, default=5, help="in each stage")
    parser.add_argument("--stages", default=",".join(STAGES))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--tmpfs", action="store_true")
    parser.add_argument("--verbose", action="store_true", help="print the error lines")
    given = parser.parse_args()
    begin = time.monotonic()
    with Lab() as lab:
        filler = Filler(lab, random.Random(given.seed))
        try:
            filler.learn()
            if given.tmpfs:
                codes = [filler.fill_tmpfs(given.verbose) for _ in range(given.places)]
                print(f"{len(codes)} sizes of a tmpfs, exit codes {codes}, same bits with room again")
                return
            for stage in given.stages.split(","):
                for _ in range(given.places):
                    filler.fill(stage, given.verbose)
        except Broken as broken:
            sys.exit(f"fill_disk.py --seed {given.seed}: {broken}")
        rows = [(stage, *row.values()) for stage, row in filler.rows.items() if row["places"]]
        totals = [sum(column) for column in list(zip(*rows))[1:]]
        print(table([*rows, ("all", *totals)], ["stage", "places", "exit code 4", "went on", "same bits"]))
        print(f"{time.monotonic() - begin:.0f} s")


if __name__ == "__main__":
    main()

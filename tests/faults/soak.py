#!/usr/bin/env python3
"""Random small scenes with random options, killed at random and resumed, for as long as is asked for.

usage: soak.py [--minutes N] [--seed S]

A round makes a scene, runs it undisturbed, runs it again with another number of threads and other checkpoints while it
is killed some times, and compares the bits. Between rounds a long training is watched: its memory and its open files
must not grow. One line a round; the first round that fails ends the soak and says how to repeat it.
"""

import argparse
import random
import signal
import sys
import time
from pathlib import Path

from lab import Broken, Lab, error_of, require, results

WARM_UP = 0.3  # of a training, after which nothing may grow any more
GROWTH = 1.05  # of the memory after that, for what an allocator keeps


class Watch:
    """Memory and open files of a process while it trains."""

    def __init__(self, pid):
        self.pid, self.samples = Path(f"/proc/{pid}"), []

    def sample(self):
        try:
            status = (self.pid / "status").read_text()
            kilobytes = int(status.split("VmRSS:")[1].split()[0])
            files = len(list((self.pid / "fd").iterdir()))
            threads = int(status.split("Threads:")[1].split()[0])
        except (OSError, IndexError):
            return  # it has ended
        self.samples.append((kilobytes, files, threads))

    def check(self):
        """Nothing grows from the middle of the training to its end."""
        kept = self.samples[int(WARM_UP * len(self.samples)) :]
        if len(kept) < 9:
            return "too short to tell"
        third = len(kept) // 3
        early, late = kept[:third], kept[-third:]
        for index, (what, factor) in enumerate([("memory (kB)", GROWTH), ("open files", 1), ("threads", 1)]):
            # Samples meet a file that is being written now and then: the smallest of a third is free of that.
            before, after = min(s[index] for s in early), min(s[index] for s in late)
            require(after <= factor * before, f"{what} grow from {before} to {after} in {len(kept)} samples")
        return f"{kept[-1][0] // 1024} MB and {min(s[1] for s in late)} files at the end of {len(kept)} samples"


def choose(numbers):
    """A scene and options, in that order."""
    width = numbers.choice([48, 64, 80, 96])
    scene = ["--demo-views", numbers.randrange(6, 11), "--width", width, "--height", width * 3 // 4, "--samples", 1]
    options = ["--seed", numbers.randrange(1000), "--iterations", numbers.randrange(20, 200),
               "--quality", numbers.choice(["draft", "normal", "high"]),
               "--proposers", numbers.choice(["none", "warp", "proxies", "proxies,warp"]),
               "--proposals", numbers.randrange(1, 6), "--test-every", numbers.choice([0, 3, 4]),
               "--init", numbers.choice(["auto", "dense", "sfm", "random"]), "--set", f"sh-degree={numbers.randrange(4)}",
               "--max-gaussians", numbers.randrange(500, 3000), "--set", "random-points=1000",
               "--oracle", numbers.choice(["auto", "consistency", "uniform"]),
               "--exposure", numbers.choice(["off", "on"])]  # fmt: skip
    return scene, options


def pace(numbers):
    """Options that must not matter."""
    return ["--threads", numbers.randrange(1, 4), "--checkpoint-every", numbers.choice([0, 7, 20, 50])]


def kill_once(lab, numbers, out, source, options, seconds):
    """False when the run came to its end before."""
    run = lab.start(out, *options, *pace(numbers), source=source, start_new_session=True)
    time.sleep(numbers.random() * seconds)
    how = numbers.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
    run.process.send_signal(how)
    code, text = run.wait()
    require(code in (0, 130, -how), f"exit code {code}:\n{text}")
    require(code != 0 or (out / "metrics.json").exists(), text)
    lab.check_no_orphans()
    lab.check_surroundings()
    lab.check_records(out)
    return code != 0


def play(numbers):
    """One round; what it was, in words."""
    scene, options = choose(numbers)
    with Lab(scene=scene) as lab:
        posed = numbers.random() < 0.4  # a scene with poses needs no registration
        source = lab.scene if posed else lab.photos
        begin = time.monotonic()
        reference = lab.dir / "reference"
        code, text = lab.start(reference, *options, *pace(numbers), source=source).wait()
        if code == 3:  # such as --init dense where stereo finds no points
            return 0, f"refused: {error_of(text)}"
        require(code == 0, text)
        seconds = time.monotonic() - begin
        expected = results(reference)
        out, kills = lab.dir / "disturbed", numbers.randrange(1, 5)
        kills = sum(kill_once(lab, numbers, out, source, options, seconds) for _ in range(kills))
        lab.finish(out, *options, *pace(numbers), source=source)
        lab.check_no_orphans()
        lab.check_surroundings()
        lab.check_finished(out, expected)
    words = " ".join(map(str, [*scene[:4], *options]))
    return kills, f"{kills} kills, same bits; {'poses' if posed else 'photos'}, {words}"


def train_long(iterations):
    """A training that is watched."""
    with Lab() as lab:
        out = lab.dir / "long"
        run = lab.start(out, "--iterations", iterations, "--checkpoint-every", max(1, iterations // 40), "--threads", 2,
                        "--max-gaussians", 1500, "--set", "refine-every=50")  # fmt: skip
        require(run.wait_for("train"), run.text())
        watch = Watch(run.process.pid)
        while run.stage == "train" and run.process.poll() is None:
            watch.sample()
            time.sleep(0.02)
        code, text = run.wait(3600)
        require(code == 0, text)
        lab.check_no_orphans()
        lab.check_surroundings()
        return watch.check()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--minutes", type=float, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--long", type=int, default=3000, help="iterations of the training that is watched; 0 = none")
    given = parser.parse_args()
    end = time.monotonic() + 60 * given.minutes
    rounds = kills = 0
    try:
        if given.long > 0:
            print(f"training of {given.long} iterations: {train_long(given.long)}", flush=True)
        while time.monotonic() < end:
            number = given.seed + rounds
            begin = time.monotonic()
            more, what = play(random.Random(number))
            rounds, kills = rounds + 1, kills + more
            print(f"round {rounds} (seed {number}, {time.monotonic() - begin:.0f} s): {what}", flush=True)
    except Broken as broken:
        sys.exit(f"soak.py --seed {given.seed + rounds}, round 1 repeats this: {broken}")
    print(f"{rounds} rounds, {kills} kills, every one resumed to the same bits, no process or file left")


if __name__ == "__main__":
    main()

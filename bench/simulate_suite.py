#!/usr/bin/env python3
"""A night of runs on a cluster, simulated: how long it takes, and what limits it.

Runs are started in their order as GPUs become free (list scheduling, as Slurm does with a job array). Each reads its
photos and writes its results over a file system that all share, and computes in between. Some runs take long, some
break down and are started again. Prints Markdown tables, means over ten nights, the same for the same seed; docs/scaling.md
quotes them.

All times of a GPU are assumptions (--minutes, --spread, --stragglers): none has been measured.
"""

import argparse
import math
import random
from dataclasses import dataclass, replace

# Bytes of one Gaussian: in a .ply, 62 floats; in a checkpoint, 59 parameters and two moments of each, those of spherical
# harmonics in 16 bits; and the gradients that several GPUs of one training would have to exchange in each iteration.
PLY_BYTES, CHECKPOINT_BYTES, GRADIENT_BYTES = 62 * 4, 59 * 4 + 2 * (11 * 4 + 48 * 2), 59 * 4

# Seconds of a run of docs/benchmarks.md (fox, 2500 iterations, two CPU cores), and which stages --spread divides.
STAGES = {"sfm": (16, False), "depth": (23, False), "proxies, propose": (64, True), "validate": (11, True), "train": (38, False)}
WHOLE = 157

NIGHTS = 10  # whose mean is printed


@dataclass(frozen=True)
class Scene:
    """Sizes of one scene; each a choice, none measured."""

    photos: int = 24
    photo_bytes: float = 4e6
    proposals: int = 96
    width: int = 1237
    height: int = 822
    png_share: float = 0.6  # of the bytes of the pixels
    gaussians: int = 1_000_000
    checkpoints: int = 10  # written in a run: every 1000 of 10 000 iterations

    def volumes(self):
        image = 3 * self.width * self.height * self.png_share
        return {
            "photos, read": self.photos * self.photo_bytes,
            "proposals, written": self.proposals * image,
            "confidence of proposals, written": self.proposals * image / 3,
            "model, written": self.gaussians * PLY_BYTES,
            "checkpoints, written": self.checkpoints * self.gaussians * CHECKPOINT_BYTES,
        }


@dataclass(frozen=True)
class Night:
    scenes: int = 1000
    gpus: int = 64
    minutes: float = 20.0  # median of a run's computing
    spread: float = 0.35  # standard deviation of the logarithm of it
    stragglers: float = 0.02  # runs that take three times as long
    failures: float = 0.03  # chance of each start to break down, at any moment
    retries: int = 2
    start_seconds: float = 10.0  # from a free GPU to a program that runs
    disk: float = 2e9  # bytes a second of the shared file system
    link: float = 1e9  # bytes a second of one machine
    longest_first: bool = False
    seed: int = 1


def work_of(night):
    """Seconds of computing of each scene: the same for any number of GPUs."""
    draw = random.Random(night.seed)
    work = []
    for _ in range(night.scenes):
        seconds = 60 * night.minutes * math.exp(draw.gauss(0, night.spread))
        work.append(seconds * (3 if draw.random() < night.stragglers else 1))
    return sorted(work, reverse=True) if night.longest_first else work


@dataclass
class Start:
    scene: int
    attempt: int
    left: float  # seconds of computing that earlier starts have not done


def simulate(night, scene=Scene()):
    """Returns seconds of the night, of all computing, of waiting for the disk, starts and scenes that never ended."""
    volumes = scene.volumes()
    read = volumes["photos, read"]
    write = sum(volumes.values()) - read
    work = work_of(night)
    draws = [random.Random(night.seed * 1_000_003 + i) for i in range(night.scenes)]  # of one scene, for any order
    waiting = [Start(i, 0, seconds) for i, seconds in enumerate(work)]
    waiting.reverse()
    now, gave_up, starts, moving_seconds = 0.0, 0, 0, 0.0
    computing = {}  # GPU: (end, what follows)
    moving = {}  # GPU: [bytes left, what follows]
    free = list(range(night.gpus))[::-1]

    def begin(gpu, start):
        nonlocal starts
        starts += 1
        computing[gpu] = (now + night.start_seconds, ("read", start))

    def step(gpu, event):
        nonlocal gave_up
        kind, start = event
        if kind == "read":
            moving[gpu] = [read, ("compute", start)]
        elif kind == "compute":
            draw = draws[start.scene]
            if draw.random() < night.failures:
                done = draw.random() * start.left
                # It goes on from its last checkpoint.
                part = work[start.scene] / scene.checkpoints
                kept = math.floor((work[start.scene] - start.left + done) / part) * part
                computing[gpu] = (now + done, ("broken", Start(start.scene, start.attempt + 1, work[start.scene] - kept)))
            else:
                computing[gpu] = (now + start.left, ("write", start))
        elif kind == "write":
            moving[gpu] = [write, ("done", start)]
        else:
            if kind == "broken" and start.attempt <= night.retries:
                waiting.insert(0, start)  # submitted again: behind all others
            elif kind == "broken":
                gave_up += 1
            free.append(gpu)

    while waiting or computing or moving:
        while free and waiting:
            begin(free.pop(), waiting.pop())
        rate = min(night.link, night.disk / len(moving)) if moving else 0.0
        ends = [(end, gpu) for gpu, (end, _) in computing.items()]
        ends += [(now + left / rate, gpu) for gpu, (left, _) in moving.items()]
        then, gpu = min(ends)
        for other in moving.values():
            other[0] -= rate * (then - now)
        moving_seconds += len(moving) * (then - now)
        now = then
        step(gpu, computing.pop(gpu)[1] if gpu in computing else moving.pop(gpu)[1])
    return now, sum(work), moving_seconds, starts, gave_up


def print_table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("| " + " | ".join("---" for _ in head) + " |")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def print_volumes(scene):
    volumes = scene.volumes()
    rows = [[name, f"{value / 1e6:.0f} MB"] for name, value in volumes.items()]
    rows.append(["all of a run", f"{sum(volumes.values()) / 1e9:.2f} GB"])
    print_table(["one run moves", "bytes"], rows)


def print_split():
    split = sum(seconds for seconds, splits in STAGES.values() if splits)
    rows = [[str(k), f"{WHOLE - split + split / k:.0f} s", f"{WHOLE / (WHOLE - split + split / k):.2f}"] for k in (1, 2, 4, 8)]
    rows.append(["any number", f"{WHOLE - split} s", f"{WHOLE / (WHOLE - split):.2f}"])
    print_table(["devices for one run", "seconds", "speed-up"], rows)


def mean_of(night):
    """Means over nights of several seeds: hours, hours at best, share of the GPUs' time, of waiting, starts again, given up."""
    sums = [0.0] * 6
    for seed in range(night.seed, night.seed + NIGHTS):
        one = replace(night, seed=seed)
        took, work, moved, starts, gave_up = simulate(one)
        best = max(work / one.gpus, max(work_of(one)))
        values = (took / 3600, best / 3600, work / took / one.gpus, moved / took / one.gpus, starts - one.scenes, gave_up)
        sums = [total + value / NIGHTS for total, value in zip(sums, values)]
    return sums


def print_gpus(night):
    rows = []
    for gpus in (1, 8, 16, 32, 64, 128, 256):
        took, _, used, moved, _, _ = mean_of(replace(night, gpus=gpus))
        rows.append([str(gpus), f"{took:.1f}", f"{used * gpus:.1f}", f"{100 * used:.0f} %", f"{100 * moved:.1f} %"])
    print_table(["GPUs", "hours", "speed-up", "of the GPUs' time used", "waiting for files"], rows)


def print_nights(night):
    variants = {
        "as above": {},
        "nothing breaks down": {"failures": 0.0},
        "one start in ten breaks down": {"failures": 0.1},
        "longest runs first": {"longest_first": True},
        "no stragglers": {"stragglers": 0.0},
        "file system with 200 MB/s": {"disk": 2e8},
        "file system with 100 MB/s": {"disk": 1e8},
        "runs of 2 minutes": {"minutes": 2.0},
        "runs of 2 minutes, 200 MB/s": {"minutes": 2.0, "disk": 2e8},
    }
    rows = []
    for name, changes in variants.items():
        took, best, used, _, again, gave_up = mean_of(replace(night, **changes))
        rows.append([name, f"{took:.2f}", f"{best:.2f}", f"{100 * used:.0f} %", f"{again:.1f}", f"{gave_up:.1f}"])
    print_table([f"{night.gpus} GPUs", "hours", "at best", "of the GPUs' time used", "starts again", "given up"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=Night.scenes)
    parser.add_argument("--gpus", type=int, default=Night.gpus)
    parser.add_argument("--minutes", type=float, default=Night.minutes, help="median of a run, an assumption")
    parser.add_argument("--spread", type=float, default=Night.spread)
    parser.add_argument("--stragglers", type=float, default=Night.stragglers)
    parser.add_argument("--seed", type=int, default=Night.seed)
    options = parser.parse_args()
    if min(options.scenes, options.gpus) < 1 or options.minutes <= 0:
        parser.error("--scenes and --gpus are at least 1, --minutes is above 0")
    night = Night(**vars(options))
    print_volumes(Scene())
    print_split()
    print_gpus(night)
    print_nights(night)
    gaussians = Scene.gaussians
    rate = night.gpus * sum(Scene().volumes().values()) / (60 * night.minutes)
    print(f"{night.gpus} GPUs with runs of {night.minutes:g} minutes move {rate / 1e9:.2f} GB/s on average.\n")
    print(f"Gradients of one iteration: {gaussians * GRADIENT_BYTES / 1e6:.0f} MB; "
          f"a ring of 8 GPUs sends {2 * 7 / 8 * gaussians * GRADIENT_BYTES / 1e6:.0f} MB from each, "
          f"{2 * 7 / 8 * gaussians * GRADIENT_BYTES * 10000 / 1e12:.2f} TB in 10 000 iterations.")  # fmt: skip


if __name__ == "__main__":
    main()

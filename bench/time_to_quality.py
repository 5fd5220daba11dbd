#!/usr/bin/env python3
"""Measures how good a picture is against how long the whole run took, and prints a Markdown table.

Every setting of every scene is a run of its own in OUT_FOLDER, the settings taking turns, so that a machine that slows
down slows all of them down. A point of a curve is a finished run, not a model halfway through one. What has been measured
is kept in OUT_FOLDER/points.json; runs that it has are not made again. With matplotlib (Debian: python3-matplotlib) the
curves are also drawn, in OUT_FOLDER/time_to_quality.svg.

  bench/time_to_quality.py DATA OUT                          # the usual settings on all scenes that are there
  bench/time_to_quality.py DATA OUT --scenes fox --rounds 3 \\
      --setting "half: --iterations 3500" --setting "old@before: --iterations 7000" --program before=OLD/bin/oraclegs
  bench/time_to_quality.py DATA OUT --scenes fox --opensplat "opensplat --num-downscales 0" --iterations 200,500,1000
  bench/time_to_quality.py DATA OUT --scenes fox --opensplat "opensplat --num-downscales 0" --iterations 2500 --minutes 2,5,10
"""

import argparse
import json
import os
import re
import shlex
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path

BIN = Path(__file__).resolve().parent.parent / "build/release/bin/oraclegs"
SCENES = {  # the protocol of docs/benchmarks.md
    "fox": ["--eval", "--views", "12", "--downscale", "2"],
    "lego": ["--background", "white", "--downscale", "2"],
    "sceaux": ["--test-views", "7103,7107", "--downscale", "2"],
    "demo": ["--views", "12"],
}
USUAL = [
    "draft: --quality draft",
    "1500: --iterations 1500 --max-gaussians 100000",
    "3000: --iterations 3000 --max-gaussians 100000",
    "7000: --iterations 7000 --max-gaussians 100000",
]


def say(*words):
    print("+", *words, file=sys.stderr, flush=True)


def run(command, log, **how):
    """Runs a program, its words in a file; returns its seconds."""
    say(*command)
    begin = time.monotonic()
    with open(log, "w") as out:
        if subprocess.run([str(word) for word in command], stdout=out, stderr=subprocess.STDOUT, **how).returncode:
            sys.exit(f"{log}: {command[0]} failed; its last words:\n{tail(log)}")
    return time.monotonic() - begin


def tail(path):
    return "\n".join(path.read_text(errors="replace").splitlines()[-5:])


class Points:
    """What has been measured, in a file."""

    def __init__(self, path):
        self.path = path
        self.rows = json.loads(path.read_text()) if path.exists() else []

    def has(self, **key):
        return any(all(row.get(name) == value for name, value in key.items()) for row in self.rows)

    def add(self, *rows):
        self.rows += rows
        temporary = self.path.with_suffix(".tmp")
        temporary.write_text(json.dumps(self.rows, indent=1) + "\n")
        os.replace(temporary, self.path)


# ---- Our own runs


def parse_setting(text, programs):
    """NAME[@PROGRAM]: OPTIONS"""
    match = re.fullmatch(r"([^:@]+)(?:@([^:]+))?:(.*)", text)
    if not match:
        sys.exit(f'--setting "{text}": expected NAME: OPTIONS, or NAME@PROGRAM: OPTIONS')
    name, program, options = match.groups()
    if program and program not in programs:
        sys.exit(f'--setting "{text}": no --program {program}=PATH')
    return name.strip(), programs.get(program, BIN), shlex.split(options)


def knows(program, option):
    answer = subprocess.run([program, "reconstruct", "--help-all"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    if answer.returncode:  # older still
        answer = subprocess.run([program, "reconstruct", "--help"], stdout=subprocess.PIPE, text=True, check=True)
    return option in answer.stdout.split()


def measure(scene, source, setting, number, out):
    name, program, options = setting
    folder = out / f"{scene}-{name}-{number}"
    shutil.rmtree(folder, ignore_errors=True)
    scene_options = list(SCENES[scene])
    if "--quality" in options and "--downscale" in scene_options:  # which decides the size
        at = scene_options.index("--downscale")
        del scene_options[at : at + 2]
    if "--eval" in scene_options and not knows(program, "--eval"):  # a version that tests without being asked to
        scene_options.remove("--eval")
    command = [program, "reconstruct", source, "-o", folder, "--quiet", *scene_options, "--seed", number, *options]
    seconds = run(command, out / f"{folder.name}.log")
    metrics = json.loads((folder / "metrics.json").read_text())
    test = metrics["test"]
    return {
        "scene": scene, "setting": name, "round": number, "seconds": seconds, "psnr": test["psnr"], "ssim": test["ssim"],
        "psnr_color_corrected": test["psnr_color_corrected"], "gaussians": metrics["gaussians"],
        "stages": {stage: part["seconds"] for stage, part in metrics["stages"].items()},
    }  # fmt: skip


# ---- OpenSplat, on the same views, undistorted and of the same size, from the same points


def opensplat_folder(scene, source, out):
    """transforms.json of the training views alone, with the points that our sfm found."""
    ours = out / f"{scene}-sfm"
    dataset = out / f"{scene}-for-opensplat"
    if (dataset / "transforms.json").exists() and not (dataset / "sparse").exists():
        return dataset
    run([BIN, "sfm", source, "-o", ours, "--quiet", "--overwrite", *SCENES[scene]], out / f"{ours.name}.log")
    run([BIN, "cameras", ours, "-o", dataset, "--quiet"], out / f"{dataset.name}.log")
    transforms = json.loads((dataset / "transforms.json").read_text())
    train = set(transforms["train_filenames"])
    transforms["frames"] = [frame for frame in transforms["frames"] if frame["file_path"] in train]
    (dataset / "transforms.json").write_text(json.dumps(transforms))
    shutil.rmtree(dataset / "sparse")  # which has the test views, and is read first
    return dataset


def score_opensplat(scene, source, ply, seconds, iterations, out):
    scores = out / f"{ply.stem}-scores"
    run([BIN, "evaluate", source, "--ply", ply, "-o", scores, "--quiet", *SCENES[scene]], out / f"{scores.name}.log")
    test = json.loads((scores / "metrics.json").read_text())["test"]
    return {
        "scene": scene, "setting": "OpenSplat", "round": 0, "seconds": seconds, "psnr": test["psnr"],
        "ssim": test["ssim"], "psnr_color_corrected": test["psnr_color_corrected"], "iterations": iterations,
        "stages": {"train": seconds},
    }  # fmt: skip


def measure_opensplat(scene, source, command, iterations, out):
    """A run of its own for a number of iterations."""
    dataset = opensplat_folder(scene, source, out)
    ply = out / f"{scene}-opensplat-{iterations}.ply"
    words = [*shlex.split(command), dataset, "-n", iterations, "-o", ply, "--keep-crs"]
    seconds = run(words, out / f"{ply.stem}.log")
    return [score_opensplat(scene, source, ply, seconds, iterations, out)]


SNAPSHOT_EVERY = 25  # iterations


def snapshots(folder):
    """The models that OpenSplat has written, as (iteration, path), but the last one, which may be half written."""
    found = [(int(path.stem.rsplit("_", 1)[1]), path) for path in folder.glob("splat_*.ply")]
    return sorted(found)[:-1]


def measure_opensplat_course(scene, source, command, iterations, minutes, out):
    """One run, whose models after each of `minutes` are scored; it ends with the last of them."""
    dataset = opensplat_folder(scene, source, out)
    folder = out / f"{scene}-opensplat-course"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    words = [*shlex.split(command), dataset, "-n", iterations, "-o", folder / "splat.ply", "--keep-crs", "-s", SNAPSHOT_EVERY]
    say(*words)
    taken = []
    begin = time.monotonic()
    with open(out / f"{folder.name}.log", "w") as log:
        process = subprocess.Popen([str(word) for word in words], stdout=log, stderr=subprocess.STDOUT)
        for minute in sorted(minutes):
            while process.poll() is None and time.monotonic() - begin < 60 * minute:
                time.sleep(0.5)
                for _, old in snapshots(folder)[:-1]:
                    old.unlink()
            found = snapshots(folder)
            if found:
                iteration, path = found[-1]
                taken.append((iteration, time.monotonic() - begin, path.rename(out / f"{scene}-opensplat-{minute}min.ply")))
            if process.poll() is not None:
                break
        ended_by_itself = process.poll() is not None
        process.kill()
        if process.wait() and ended_by_itself:
            sys.exit(f"{log.name}: OpenSplat failed; its last words:\n{tail(Path(log.name))}")
    shutil.rmtree(folder)
    if len(taken) < len(minutes):
        say(f"{scene}: OpenSplat has a model at {len(taken)} of {len(minutes)} times; --iterations {iterations} ended it, or it is slow")
    return [score_opensplat(scene, source, ply, seconds, iteration, out) for iteration, seconds, ply in taken]


# ---- What is shown


def middle(rows, value):
    return statistics.median(value(row) for row in rows)


def by_setting(rows):
    groups = {}
    for row in rows:
        name = f"{row['setting']}, {row['iterations']} iterations" if "iterations" in row else row["setting"]
        groups.setdefault((row["scene"], name), []).append(row)
    return groups


def print_table(rows):
    parts = ["sfm", "depth", "proxies", "propose", "validate", "train", "evaluate"]
    header = ["scene", "setting", "runs", "PSNR", "SSIM", "PSNR, color-corrected", "seconds", *parts]
    print("| " + " | ".join(header) + " |\n" + "| --- " * len(header) + "|")
    for (scene, name), group in by_setting(rows).items():
        cells = [scene, name, len(group), f"{middle(group, lambda r: r['psnr']):.2f}",
                 f"{middle(group, lambda r: r['ssim']):.4f}", f"{middle(group, lambda r: r['psnr_color_corrected']):.2f}",
                 f"{middle(group, lambda r: r['seconds']):.0f}"]  # fmt: skip
        for part in parts:
            took = middle(group, lambda r: r["stages"].get(part, 0))
            cells.append(f"{took:.0f}" if took >= 0.5 else "")
        print("| " + " | ".join(map(str, cells)) + " |")


def draw(rows, path):
    try:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        say("without a plot: python3-matplotlib is not installed")
        return
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    figure, axes = pyplot.subplots(1, len(scenes), figsize=(4.2 * len(scenes), 3.6), squeeze=False)
    for scene, axis in zip(scenes, axes[0]):
        ours, others = [], []
        for (where, name), group in by_setting(rows).items():
            if where != scene:
                continue
            point = (middle(group, lambda r: r["seconds"]), middle(group, lambda r: r["psnr"]))
            (others if name.startswith("OpenSplat") else ours).append(point)
            axis.annotate(name, point, fontsize=7, textcoords="offset points", xytext=(4, -9))
        axis.plot(*zip(*sorted(ours)), "o-", label="OracleGS") if ours else None
        axis.plot(*zip(*sorted(others)), "s--", label="OpenSplat") if others else None
        axis.set(title=scene, xlabel="seconds of the whole run", ylabel="PSNR of test views, dB")
        axis.legend(fontsize=7, loc="lower right")
        axis.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(path)
    say(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path, metavar="DATA", help="folder with fox, lego and sceaux, or some of them")
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for the runs")
    parser.add_argument("--scenes", default=",".join(SCENES), help="default: %(default)s; what is not there is left out")
    parser.add_argument("--setting", action="append", metavar="TEXT", help="NAME: OPTIONS, or NAME@PROGRAM: OPTIONS")
    parser.add_argument("--program", action="append", default=[], metavar="NAME=PATH", help="another build's oraclegs")
    parser.add_argument("--rounds", type=int, default=1, help="runs of each setting, of seeds 0, 1, ...")
    parser.add_argument("--opensplat", metavar="COMMAND", help="OpenSplat's program with options, to be measured beside ours")
    parser.add_argument("--iterations", default="200,500,1000", help="how long OpenSplat trains; default: %(default)s")
    parser.add_argument(
        "--minutes", metavar="LIST", help="score one run of OpenSplat, of the largest of --iterations, at these times, say 2,5,10"
    )
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    programs = dict(text.split("=", 1) for text in args.program)
    settings = [parse_setting(text, programs) for text in args.setting or USUAL]
    points = Points(args.out / "points.json")
    sources = {}
    for scene in args.scenes.split(","):
        if scene not in SCENES:
            parser.error(f"--scenes {scene}: there are {', '.join(SCENES)}")
        sources[scene] = args.data / scene
        if scene == "demo":
            sources[scene] = args.out / "demo-scene"
            if not (sources[scene] / "demo_scene.json").exists():
                run([BIN, "demo-scene", sources[scene], "--quiet"], args.out / "demo-scene.log")
        elif not sources[scene].is_dir():
            say(f"{sources[scene]} is not there: measuring without it")
            del sources[scene]
    for number in range(args.rounds):
        for scene, source in sources.items():
            for setting in settings:
                if not points.has(scene=scene, setting=setting[0], round=number):
                    points.add(measure(scene, source, setting, number, args.out))
    if args.opensplat:
        for scene, source in sources.items():
            lengths = [int(word) for word in args.iterations.split(",")]
            if args.minutes:
                if not points.has(scene=scene, setting="OpenSplat"):
                    minutes = [float(word) for word in args.minutes.split(",")]
                    new = measure_opensplat_course(scene, source, args.opensplat, max(lengths), minutes, args.out)
                    points.add(*new)
                continue
            for iterations in lengths:
                if not points.has(scene=scene, setting="OpenSplat", iterations=iterations):
                    points.add(*measure_opensplat(scene, source, args.opensplat, iterations, args.out))
    print_table(points.rows)
    draw(points.rows, args.out / "time_to_quality.svg")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Measures how time and memory grow with photos, pixels, Gaussians and cores, and prints a Markdown table for each.

Each setting of each scene is a run of its own in OUT, one after another; of each axis one option changes and the others
of FIXED stay. A run that is finished there is not made again. Below a table stand the exponents of each scene: the slope of
log seconds, or log bytes, against log photos and so on, by least squares over the settings. 1 is in proportion, on the axis of
cores -1 is perfect. Stages that take less than a second in all settings have none.

- Photos are training views (--views). Where a scene has poses, stage sfm finds only points, and there is no register. Of up
  to 60 photos without poses, register takes all, whatever --views says.
- Pixels are those of a photo in training (--max-size). COLMAP reads the photos as they are, so register and sfm stay the same.
- Gaussians are those at the end, which may be less than --max-gaussians allows.
- Cores are those that the program and COLMAP may run on, and --threads.
- Memory is the most that was resident, of the program and, beside it, of the largest that it starts, as COLMAP.

  bench/growth.py DATA OUT --plot growth.svg                       # all axes of fox, room and bonsai
  bench/growth.py DATA OUT --scenes fox --axis photos --photos 3,6,12 --options "--proposers none"
"""

import argparse
import json
import math
import os
import shlex
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import log_plot
import watched

BIN = Path(__file__).resolve().parent.parent / "build/release/bin/oraclegs"
FIXED = {"--views": "12", "--max-size": "500", "--iterations": "1000", "--max-gaussians": "100000",
         "--trajectory": "coverage"}  # at the poses of other photos there would be fewer proposals, the more photos train
AXES = {"photos": "--views", "pixels": "--max-size", "gaussians": "--max-gaussians", "cores": "--threads"}
STAGES = ["register", "sfm", "poses", "depth", "proxies", "propose", "validate", "train", "evaluate", "report"]
COLUMNS = [*STAGES, "rest", "whole", "memory", "child's memory"]  # rest: what no stage's time holds
STEEPEST = 1.15
SHORT = 1  # seconds
CAUSES = {
    ("photos", "register"): "all pairs of up to 60 photos are matched, and all cameras adjusted again as photos join",
    ("photos", "sfm"): "all pairs of up to 60 photos are matched",
    ("photos", "poses"): "stereo compares each of up to 6 photos with all others",
    ("photos", "depth"): "stereo compares each of up to 6 photos with all others",
}
COLORS = ["#9c755f", "#4e79a7", "#17a2a8", "#59a14f", "#e08214", "#b6992d", "#b07aa1", "#d6342c", "#c9379d", "#7f7f7f",
          "#a0a0a0", "#111111"]  # of the columns that are seconds


# ---- A run


def measure(command, folder, cores):
    """What a run took; None where it failed. Kept in the run's folder."""
    kept, words = folder / "growth.json", [str(word) for word in command]
    if kept.exists() and (found := json.loads(kept.read_text()))["command"] == words:
        return found
    shutil.rmtree(folder, ignore_errors=True)
    log = folder.with_name(folder.name + ".log")
    code, whole, peaks = watched.run(command, log, cores)
    if code:
        print(f"{log}: failed with exit code {code}; measuring without it", file=sys.stderr)
        return None
    metrics = json.loads((folder / "metrics.json").read_text())
    records = json.loads((folder / "stages.json").read_text())
    taken = {stage: records[stage]["seconds"] for stage in STAGES if stage in records}
    own = peaks.pop(Path(words[0]).name[:15], 0)  # the system cuts names
    result = {
        "command": words, **taken, "rest": max(0, whole - sum(taken.values())), "whole": whole,
        "memory": max(own, metrics["peak_memory_bytes"]) / 1e9, "child's memory": max(peaks.values(), default=0) / 1e9,
        "photos": len(json.loads((folder / "split.json").read_text())["train"]), "gaussians": metrics["gaussians"],
        "proposals": records.get("propose", {}).get("targets", 0),
    }  # fmt: skip
    kept.write_text(json.dumps(result, indent=1) + "\n")
    return result


def settings(axis, wanted, scene):
    """{number on the axis: value of the option} of what a scene, as `oraclegs info` tells, and this machine can do."""
    if axis == "photos":
        return {n: n for n in wanted if n <= scene["views"]}
    if axis == "cores":
        return {n: n for n in wanted if n <= len(os.sched_getaffinity(0))}
    if axis == "gaussians":
        return {n: n for n in wanted}
    size = max(scene["sizes"], key=scene["sizes"].get)
    short, long = sorted(int(side) for side in size.split("x"))
    return {min(n, long) * round(min(n, long) * short / long): min(n, long) for n in wanted}


def without(option, words):
    """Words of a command without an option and its value."""
    if option in words:
        at = words.index(option)
        words = words[:at] + words[at + 2 :]
    return [word for word in words if not word.startswith(f"{option}=")]


def measure_axis(axis, wanted, name, given):
    """A row for each setting, in which "at" is the place on the axis."""
    source, rows = given.data / name, []
    scene = json.loads(subprocess.run([given.program, "info", source, "--json"], capture_output=True, check=True).stdout)
    more = without(AXES[axis], shlex.split(given.options))
    replaced = {word.split("=")[0] for word in more}
    for at, value in settings(axis, wanted, scene).items():
        options = {**FIXED, "--views": str(min(int(FIXED["--views"]), scene["views"])), AXES[axis]: str(value)}
        words = [word for pair in options.items() if pair[0] not in replaced for word in pair]
        folder = given.out / f"{name}-{axis}-{value}"
        command = [given.program, "reconstruct", source, "-o", folder, "--quiet", "--seed", "0", *words, *more]
        row = measure(command, folder, value if axis == "cores" else None)
        if row:
            rows.append({**row, "scene": name, "at": row.get(axis, at)})
    return rows


# ---- What is shown


def exponent(places, values):
    """Slope of log values against log places, of those that are above 0; None where there are less than two places."""
    points = [(math.log(place), math.log(value)) for place, value in zip(places, values) if value > 0]
    if len({x for x, _ in points}) < 2:
        return None
    return round(statistics.linear_regression(*zip(*points)).slope, 2) + 0.0  # no -0.00


def exponents(rows):
    """{column: exponent} of a scene's rows."""
    found = {}
    for column in COLUMNS:
        values = [row.get(column, 0) for row in rows]
        slope = exponent([row["at"] for row in rows], values)
        if slope is not None and ("memory" in column or max(values) >= SHORT):
            found[column] = slope
    return found


def word(axis):
    return "Gaussians" if axis == "gaussians" else axis


def by_scene(rows):
    return {name: [row for row in rows if row["scene"] == name] for name in dict.fromkeys(row["scene"] for row in rows)}


def table(axis, rows):
    """Markdown: a row for each setting, the exponents of each scene, and what is known of those that are steep."""
    shown = [column for column in COLUMNS if any(row.get(column) for row in rows)]
    units = [f"{column}, GB" if "memory" in column else column for column in shown]
    lines = ["| " + " | ".join(["scene", word(axis), "proposals", *units]) + " |", "| --- " * (3 + len(shown)) + "|"]
    for row in rows:
        cells = [row["scene"], f"{row['at']:,}".replace(",", " "), str(row["proposals"])]
        for column in shown:
            digits = 2 if "memory" in column else 1 if row.get(column, 0) < 10 else 0
            cells.append(f"{row[column]:.{digits}f}" if column in row else "")
        lines.append("| " + " | ".join(cells) + " |")
    steep = []
    for name, own in by_scene(rows).items():
        slopes = exponents(own)
        lines += ["", f"Exponents, {name}: " + (", ".join(f"{c} {s:.2f}" for c, s in slopes.items()) or "none")]
        for column, slope in slopes.items():
            if slope > STEEPEST and column != "whole":  # which is the sum of the others
                steep.append(f"- {name}, {column}: {word(axis)}^{slope:.2f}: {CAUSES.get((axis, column), 'cause unknown')}")
    return "\n".join([*lines, "", *steep] if steep else lines)


def draw(rows_of_axis, path):
    """Seconds: a panel for each axis and scene, a line for each stage that has an exponent, named with it."""
    panels = []
    for axis, rows in rows_of_axis.items():
        for name, own in by_scene(rows).items():
            own, lines = sorted(own, key=lambda row: row["at"]), []
            for column, slope in exponents(own).items():
                if "memory" not in column:
                    points = [(row["at"], row[column]) for row in own if row.get(column, 0) > 0]
                    lines.append(log_plot.Line(f"{column} {slope:.2f}", COLORS[COLUMNS.index(column)], points))
            panels.append(log_plot.Panel(f"{name}: seconds", word(axis), lines))
    note = "Seconds of each stage and, beside its name, their exponent. Both scales are logarithmic."
    path.write_text(log_plot.svg(panels, note))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path, metavar="DATA", help="folder with a folder for each scene")
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for the runs")
    parser.add_argument("--scenes", default="fox,room,bonsai", help="default: %(default)s; what is not there is left out")
    parser.add_argument("--photos", default="3,6,12,24,50,100,292", help="default: %(default)s; more than there are is left out")
    parser.add_argument("--sizes", default="250,500,1000,2000", help="longer sides; default: %(default)s; at most the photos'")
    parser.add_argument("--gaussians", default="30000,100000,300000,1000000", help="default: %(default)s")
    parser.add_argument("--cores", default="1,2", help="default: %(default)s; more than there are is left out")
    parser.add_argument("--axis", default=",".join(AXES), help="default: %(default)s")
    parser.add_argument("--options", default="", help="of each run, in place of those that are fixed")
    parser.add_argument("--plot", type=Path, metavar="FILE.svg")
    parser.add_argument("--program", type=Path, default=BIN, help="another build's oraclegs")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    wanted = {"photos": given.photos, "pixels": given.sizes, "gaussians": given.gaussians, "cores": given.cores}
    rows_of_axis = {}
    for axis in given.axis.split(","):
        if axis not in AXES:
            parser.error(f"--axis {axis}: there are {', '.join(AXES)}")
        rows = rows_of_axis[axis] = []
        for name in given.scenes.split(","):
            if (given.data / name).is_dir():
                rows += measure_axis(axis, [int(word) for word in wanted[axis].split(",")], name, given)
            else:
                print(f"{given.data / name} is not there: measuring without it", file=sys.stderr)
        print(f"\n### {axis}\n\n{table(axis, rows)}", flush=True)
        if given.plot:
            draw(rows_of_axis, given.plot)


if __name__ == "__main__":
    main()

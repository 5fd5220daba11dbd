#!/usr/bin/env python3
"""Measures every stage of a training iteration against the machine's ceilings and prints Markdown tables.

Trains what it needs (the demo scene and DATA_FOLDER/fox, 1000 and 7000 iterations, and fox from 100 000 random points) in
OUT_FOLDER unless it is there, runs build/release/bin/stage_bench and keeps its answer in OUT_FOLDER/stage_bench.json.
"""

import argparse
import json
import math
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

BIN = Path(__file__).resolve().parent.parent / "build/release/bin"
COMMON = ["--max-gaussians", "100000", "--seed", "0", "--quiet"]
STAGES = {
    "project": "project",
    "bin": "bin + sort",
    "blend": "blend",
    "loss": "L1 + SSIM",
    "blend_backward": "blend backward",
    "update": "per-Gaussian update",
}
ALONE = {
    "photometric": "L1 + SSIM, value and gradient",
    "gaussian_backward": "per-Gaussian backward",
    "backward": "backward",
    "backward_with_camera": "backward with the camera's gradient",
    "regularizers": "regularizers",
    "adam": "Adam",
    "noise": "noise",
}
STEEPEST = 1.15  # n log n over 1e4 .. 1e6 is about 1.1
QUICK = (
    "^(stages|alone)/fox(7000|dense)/(30000|100000)/270x480/|^threads/(fox7000|foxdense|synthetic)/100000/270x480/"
    "|^stages/synthetic/(10000|100000|1000000)/270x480/|^stages/synthetic/(10000|100000)/1080x1920/"
)
ALL = "^(stages|alone|threads)/"
MEMORY = ["^memory/synthetic/", "^memory/fox7000/"]


# ---- Workspaces


def run(*command):
    print("+", *command, file=sys.stderr, flush=True)
    subprocess.run([str(word) for word in command], check=True)


def make_workspaces(data, out, quick):
    """{name: folder} of finished runs."""
    oraclegs = BIN / "oraclegs"
    scenes = {"fox": (data / "fox", ["--views", "12", "--downscale", "2"])}
    if not scenes["fox"][0].is_dir():
        print(f"{data}/fox is not there: measuring without it", file=sys.stderr)
        scenes = {}
    if not quick:
        if not (out / "demo-scene/demo_scene.json").exists():
            run(oraclegs, "demo-scene", out / "demo-scene", "--quiet")
        scenes["demo"] = (out / "demo-scene", ["--views", "12"])
    variants = {f"{scene}{n}": (scene, ["--iterations", n]) for scene in sorted(scenes)
                for n in ([7000] if quick else [1000, 7000])}
    if "fox" in scenes:  # a model that was trained with 100 000 Gaussians, neither grown nor thinned
        variants["foxdense"] = ("fox", ["--iterations", 7000, "--init", "random", "--set", "random-points=100000"])
    workspaces = {}
    for name, (scene, training) in variants.items():
        source, options = scenes[scene]
        folder = workspaces[name] = out / name
        if (folder / "metrics.json").exists() and (folder / "point_cloud.ply").exists():
            continue
        sfm = out / f"{scene}-sfm"  # found once, for all of a scene's runs: COLMAP's points differ from run to run
        if not folder.exists():
            run(oraclegs, "sfm", source, "-o", sfm, *options, *COMMON)
            shutil.copytree(sfm, folder)
        run(oraclegs, "reconstruct", source, "-o", folder, *training, *options, *COMMON)
    return workspaces


# ---- Measuring


def measure(workspaces, pattern, min_time):
    """The JSON of one process of stage_bench; names go to stderr as they are done."""
    command = [str(BIN / "stage_bench"), f"--benchmark_filter={pattern}", f"--benchmark_min_time={min_time}"]
    command += ["--benchmark_format=json"] + [f"--workspace={name}={path}" for name, path in workspaces.items()]
    print("+", *command, file=sys.stderr, flush=True)
    text = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            text.append(line)
            if '"name":' in line:
                print("  " + line.split('"')[3].removesuffix("/real_time"), file=sys.stderr, flush=True)
    if process.returncode != 0:
        sys.exit(f"stage_bench ended with {process.returncode}")
    return json.loads("".join(text))


def measure_all(workspaces, quick, min_time):
    result = measure(workspaces, QUICK if quick else ALL, min_time)
    for pattern in [] if quick else MEMORY:  # a peak is a process's own
        if pattern.split("/")[1] in ["synthetic", *workspaces]:
            result["benchmarks"] += measure(workspaces, pattern, 0.01)["benchmarks"]
    return result


# ---- Tables


def table(header, rows):
    lines = [header, ["---"] * len(header)] + rows
    print("\n" + "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines))


def count(n):
    return f"{round(n):,}".replace(",", " ")


def milliseconds(ms):
    return f"{ms:.2f}" if ms < 10 else f"{ms:.1f}" if ms < 100 else f"{ms:.0f}"


def percent(share):
    return f"{100 * share:.0f} %"


def family(benchmarks, name):
    """{input: its benchmarks of a family}, in the order of measuring."""
    found = {}
    for b in benchmarks:
        words = b["name"].split("/")
        if words[0] == name:
            found.setdefault(words[1], []).append(b)
    return found


def size_of(b):
    return f"{b['width']:.0f}×{b['height']:.0f}"


def spread(values, unit):
    return f"{statistics.median(values):.1f} {unit} ({min(values):.1f} to {max(values):.1f})"


def print_ceilings(context, stages):
    print("\n### Ceilings\n")
    cache, array = int(context["last_level_cache_bytes"]) >> 20, int(context["copy_array_bytes"]) >> 20
    print(f"{context['threads']} threads, {context['simd_target']}; measured before and after each of {len(stages)} "
          "configurations, median (least to most); a share below is of the ceiling around its own configuration.\n")
    print("- multiply-adds from registers:", spread([b["fma_gflops"] for b in stages], "GFLOP/s"))
    print(f"- copy of {array} MiB (largest cache: {cache} MiB), read + written:",
          spread([b["copy_gbps"] for b in stages], "GB/s"))


def print_stages(name, stages):
    print(f"\n### {name}: iterations\n")
    print("Medians in ms, and the share of the ceiling: multiply-adds for blending (34 and 64 flops a pixel-Gaussian "
          "pair), memory for the rest (above 100 %: from the caches).")
    table(["Gaussians", "pixels", "iteration", *STAGES.values(), "pairs/s", "pairs/s backward", "pairs", "ceilings then"],
          [[count(b["gaussians"]), size_of(b), milliseconds(b["median_ms"])]
           + [f"{milliseconds(b[s + '_ms'])} ({percent(b[s + '_share'])})" for s in STAGES]
           + [f"{b[key] * 1e-9:.2f} G" for key in ("blend_pairs_per_second", "blend_backward_pairs_per_second")]
           + [f"{b['pixel_pairs'] * 1e-6:.1f} M", f"{b['fma_gflops']:.0f} GFLOP/s, {b['copy_gbps']:.0f} GB/s"]
           for b in stages])


def print_alone(name, alone):
    print(f"\n### {name}: each by itself\n")
    print("Medians in ms.")
    table(["Gaussians", "pixels", *ALONE.values()],
          [[count(b["gaussians"]), size_of(b)] + [milliseconds(b[key + "_ms"]) for key in ALONE] for b in alone])


def slope(points):
    """Of the least-squares line through (log x, log y)."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    mean_x, mean_y = (statistics.mean(column) for column in zip(*logs))
    return sum((x - mean_x) * (y - mean_y) for x, y in logs) / sum((x - mean_x) ** 2 for x, _ in logs)


def print_slopes(what, groups, x_of):
    """groups: {label: benchmarks that differ in x alone}."""
    rows = []
    for label, group in groups.items():
        group = sorted(group, key=x_of)
        if len(group) < 2:
            continue
        span = " to ".join(count(x_of(b)) for b in (group[0], group[-1]))
        row = [label, span]
        for stage in STAGES:
            s = slope([(x_of(b), b[stage + "_ms"]) for b in group])
            times = " → ".join(milliseconds(b[stage + "_ms"]) for b in group)
            row.append(f"{times}: " + (f"**{s:.2f} !**" if s > STEEPEST else f"{s:.2f}"))
        rows.append(row)
    if rows:
        table([f"time against {what}", "from, to", *STAGES.values()], rows)


def print_scaling(all_stages):
    print("\n### Scaling\n")
    print(f"ms, and the slope of log time over log size: 1 is linear, n log n is about 1.1 here; above {STEEPEST} is "
          "marked with !. Small inputs stay in the caches, large ones do not, which steepens what memory bounds.")
    by_pixels, by_gaussians = {}, {}
    for name, stages in all_stages.items():
        for b in stages:
            if b["gaussians"] == 30000:
                continue  # stands between powers of ten, at one size only
            by_gaussians.setdefault(f"{name}, {size_of(b)}", []).append(b)
            by_pixels.setdefault(f"{name}, {count(b['gaussians'])}", []).append(b)
    print_slopes("Gaussians", by_gaussians, lambda b: b["gaussians"])
    print_slopes("pixels", by_pixels, lambda b: b["width"] * b["height"])


def print_threads(threads):
    print("\n### Threads\n")
    print("Blending with 1 thread and with all, one right after the other: medians in ms, median ratio.")
    table(["input", "Gaussians", "pixels", "threads", "blend", "ratio", "blend backward", "ratio", "image, gradients"],
          [[name, count(b["gaussians"]), size_of(b), f"1, {b['threads_used']:.0f}",
            f"{milliseconds(b['blend_ms_1'])} → {milliseconds(b['blend_ms_all'])}", f"{b['blend_speedup']:.2f}",
            f"{milliseconds(b['blend_backward_ms_1'])} → {milliseconds(b['blend_backward_ms_all'])}",
            f"{b['blend_backward_speedup']:.2f}", "same bits"] for name, group in threads.items() for b in group])


def print_memory(memory):
    print("\n### Memory\n")
    print("Largest resident memory of the process: images, libraries, the last growth step and the iterations "
          "after it.")
    table(["input", "Gaussians", "pixels", "peak", "of it before training"],
          [[name, count(b["gaussians"]), size_of(b), f"{b['peak_bytes'] / 2**30:.2f} GiB",
            f"{b['input_peak_bytes'] / 2**30:.2f} GiB"] for name, group in memory.items() for b in group])


def print_tables(result):
    failed = [b for b in result["benchmarks"] if b.get("error_occurred")]
    good = [b for b in result["benchmarks"] if not b.get("error_occurred")]
    stages, alone = family(good, "stages"), family(good, "alone")
    if stages:
        print_ceilings(result["context"], [b for group in stages.values() for b in group])
    for name in stages:
        print_stages(name, stages[name])
        if name in alone:
            print_alone(name, alone[name])
    if stages:
        print_scaling(stages)
    for name, show in (("threads", print_threads), ("memory", print_memory)):
        if family(good, name):
            show(family(good, name))
    for b in failed:
        print(f"\n{b['name']}: {b['error_message']}", file=sys.stderr)
    return 1 if failed else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path, metavar="DATA_FOLDER", help="may hold fox/")
    parser.add_argument("out", type=Path, metavar="OUT_FOLDER", help="receives the runs and stage_bench.json")
    parser.add_argument("--quick", action="store_true",
                        help="fox after 7000 iterations at 270x480, threads, and scaling on the synthetic scene")
    parser.add_argument("--min-time", type=float, default=1,
                        help="seconds of each configuration (default 1); every training view is taken at least once")
    parser.add_argument("--tables", action="store_true", help="measure nothing, print the last answer again")
    args = parser.parse_args()
    answer = args.out / "stage_bench.json"
    if not args.tables:
        args.out.mkdir(parents=True, exist_ok=True)
        workspaces = make_workspaces(args.data, args.out, args.quick)
        result = measure_all(workspaces, args.quick, args.min_time)
        answer.write_text(json.dumps(result, indent=1))
    return print_tables(json.loads(answer.read_text()))


if __name__ == "__main__":
    sys.exit(main())

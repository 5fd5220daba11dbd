#!/usr/bin/env python3
"""Scores methods on scenes of all kinds, which no setting fits by chance, and prints one Markdown table.

Each scene is a benchmark of its own in OUT (`oraclegs bench`), by the protocol of SCENES; the same command goes on where it was
stopped, and more scenes, methods or seeds may be asked for. The table has the mean over seeds of PSNR / SSIM (color-corrected
PSNR) and the standard deviation of PSNR, for the mean of the scenes that of their means. Below it stands how far the first
method is ahead of the best other one, and with --before, how a change did: it pays where the mean over the scenes is higher
and no scene has lost more than seeds differ.

  bench/suite.py DATA OUT                                        # this program with and without proposals, three baselines
  bench/suite.py DATA OUT --methods ours --before OUT_BEFORE     # a change against runs of the program before it
  bench/suite.py DATA OUT --scenes fox-12,fern-3 --seeds 1 --options "--iterations 1500 --max-gaussians 30000"

With --tampering each scene is a tampering benchmark (`oraclegs ablate --compare tampering`): models of it lie in a share of the
proposed pixels. The table has the PSNR without proposals, with all of them trusted alike, as the oracle says and as an ideal
oracle would, and how well the oracle knows the tampered pixels (AUROC) where photos see. OUT has pictures, masks and JSON.

  bench/suite.py DATA OUT --tampering --options "--shares 30"
"""

import argparse
import json
import shlex
import statistics
import subprocess
import sys
from pathlib import Path

BIN = Path(__file__).resolve().parent.parent / "build/release/bin/oraclegs"
SCENES = {  # folder in DATA, protocol; docs/benchmarks.md says where they come from
    "fern-3": ("fern", "--views 3"),
    "fern-6": ("fern", "--views 6"),
    "fern-9": ("fern", "--views 9"),
    "fox-12": ("fox", "--views 12 --downscale 4"),
    "lego-8": ("lego", "--background white --downscale 2"),
    "mic-8": ("mic", "--background white --downscale 2"),
    "room-12": ("room", "--views 12 --downscale 4"),
    "sceaux-9": ("sceaux", "--test-views 7103,7107 --downscale 8"),
    "vase-8": ("vase", "--test-every 5 --downscale 4"),
}
METHODS = "ours,ours-no-proposals,dropgaussian,cor-gs,fsgs"
SCORES = ("psnr", "ssim", "psnr_color_corrected")
TRUSTS = ("none", "uniform", "oracle", "ideal")


def command_of(data, out, name, options):
    """The command line of a scene's benchmark."""
    folder, protocol = SCENES[name]
    if options.tampering:
        command, what = ["ablate", data / folder], ["--compare", "tampering"]
    else:
        command, what = ["bench", "--suite", data / folder], ["--methods", ",".join(options.methods)]
    return [options.program, *command, "-o", out / name, *what, "--seeds", options.seeds, *protocol.split(),
            *shlex.split(options.options)]  # fmt: skip


def score_all(data, out, options):
    """Runs the benchmarks of the scenes that are there, one after the other."""
    for name in options.scenes:
        folder = SCENES[name][0]
        if not (data / folder).is_dir():
            print(f"{data / folder}: is not there, {name} is left out", file=sys.stderr)
            continue
        command = command_of(data, out, name, options)
        print("+", *command, file=sys.stderr, flush=True)
        if subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL).returncode:
            sys.exit(f"{out / name}: the benchmark failed; its last words stand above")


def read(out, scenes, methods):
    """{scene: {method: [scores of a seed, ...]}}, without what has no scores."""
    found = {}
    for name in scenes:
        try:
            report = json.loads((out / name / "bench.json").read_text())
        except OSError:
            continue
        for run in report["runs"]:
            metrics = out / name / run["workspace"] / "metrics.json"
            if run["method"] not in methods or not metrics.exists():
                continue
            test = json.loads(metrics.read_text())["test"]
            if test["psnr"] is not None:
                found.setdefault(name, {}).setdefault(run["method"], []).append({key: test[key] for key in SCORES})
    return found


def mean(runs, key="psnr"):
    return statistics.fmean(run[key] for run in runs)


def deviation(runs):
    return statistics.stdev(run["psnr"] for run in runs) if len(runs) > 1 else 0.0


def cell(runs):
    psnr, ssim, corrected = (mean(runs, key) for key in SCORES)
    return f"{psnr:.2f} ± {deviation(runs):.2f} / {ssim:.4f} ({corrected:.2f})"


def means_of(found, method):
    """The means of each scene, as though scenes were seeds."""
    return [{key: mean(of[method], key) for key in SCORES} for of in found.values()]


def common(found, methods):
    """The scenes that all these methods have scores of."""
    return {name: of for name, of in found.items() if all(method in of for method in methods)}


def table(found, methods):
    lines = ["| scene | " + " | ".join(methods) + " |", "| --- " * (len(methods) + 1) + "|"]
    for name, of in found.items():
        lines.append(f"| {name} | " + " | ".join(cell(of[method]) if method in of else "" for method in methods) + " |")
    whole = common(found, methods)
    if len(whole) > 1:
        lines.append(f"| mean of {len(whole)} | " + " | ".join(cell(means_of(whole, method)) for method in methods) + " |")
    return "\n".join(lines)


def tampering_table(out, scenes):
    """A row for each scene and share: PSNR of each trust, AUROC of the oracle; of the scenes that have a report."""
    lines = ["| scene | tampered | " + " | ".join(TRUSTS) + " | AUROC |", "| --- " * (len(TRUSTS) + 3) + "|"]
    for name in scenes:
        try:
            report = json.loads((out / name / "tampering.json").read_text())
        except OSError:
            continue
        for share in report["shares"]:
            cells = [share["psnr"][trust] for trust in TRUSTS]
            words = ["" if of is None else f"{of['mean']:.2f}" for of in cells]
            auroc = "" if share["auroc"] is None else f"{share['auroc']:.3f}"
            lines.append(f"| {name} | {share['percent']} % | " + " | ".join(words) + f" | {auroc} |")
    return "\n".join(lines)


def lead(found, methods):
    """How far the first method is ahead of the one of the others that is best in the mean, scene by scene."""
    first, *others = methods
    whole = common(found, methods)
    if not others or not whole:
        return ""
    best = max(others, key=lambda method: statistics.fmean(run["psnr"] for run in means_of(whole, method)))
    ahead = {name: mean(of[first]) - mean(of[best]) for name, of in whole.items()}
    ssim = statistics.fmean(mean(of[first], "ssim") - mean(of[best], "ssim") for of in whole.values())
    scenes = ", ".join(f"{name} {value:+.2f}" for name, value in ahead.items())
    return f"{first} beside {best}: {statistics.fmean(ahead.values()):+.2f} dB, {ssim:+.4f} SSIM ({scenes})"


def verdict(before, after, method):
    """How a method changed from one folder to another, and whether that pays."""
    both = [name for name in after if method in after[name] and method in before.get(name, {})]
    if not both:
        return f"{method}: there is nothing to compare"
    changes, lost = {}, []
    for name in both:
        old, new = before[name][method], after[name][method]
        changes[name] = mean(new) - mean(old)
        if changes[name] < -max(deviation(old), deviation(new)):
            lost.append(name)
    whole = statistics.fmean(changes.values())
    scenes = ", ".join(f"{name} {value:+.2f}" for name, value in changes.items())
    pays = "pays" if whole > 0 and not lost else "does not pay" + (f": {', '.join(lost)} lost more than seeds differ" if lost else "")
    once = any(len(of[name][method]) == 1 for of in (before, after) for name in both)
    doubt = "; of one seed it is unknown how seeds differ" if once else ""
    return f"{method}: {whole:+.2f} dB in the mean ({scenes}); it {pays}{doubt}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path, help="folder with the scenes")
    parser.add_argument("out", type=Path, help="folder of the benchmarks")
    parser.add_argument("--scenes", default=",".join(SCENES), help="default: %(default)s")
    parser.add_argument("--methods", default=METHODS, help="default: %(default)s")
    parser.add_argument("--seeds", type=int, default=3, help="default: %(default)s")
    parser.add_argument("--options", default="", help="options of `oraclegs bench` for all scenes (with --tampering of `oraclegs ablate`)")
    parser.add_argument("--tampering", action="store_true", help="how far the oracle protects each scene from lies")
    parser.add_argument("--before", type=Path, help="folder of benchmarks to compare the first method with")
    parser.add_argument("--program", default=BIN, help="default: %(default)s")
    options = parser.parse_args()
    options.scenes, options.methods = options.scenes.split(","), options.methods.split(",")
    if unknown := [name for name in options.scenes if name not in SCENES]:
        parser.error(f"--scenes names {', '.join(unknown)}; there are {', '.join(SCENES)}")
    score_all(options.data, options.out, options)
    if options.tampering:
        print(tampering_table(options.out, options.scenes))
        return
    found = read(options.out, options.scenes, options.methods)
    print(table(found, options.methods))
    if text := lead(found, options.methods):
        print("\n" + text)
    if options.before:
        print("\n" + verdict(read(options.before, options.scenes, options.methods[:1]), found, options.methods[0]))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Reconstructs demo scenes of all kinds, whose true depth is known, and prints one Markdown table.

Scenes are made in OUT/scenes and runs in OUT/runs; the same command goes on where it was stopped, and more kinds may be asked
for. Of each kind the table has, of stereo at the training views, the median error of confident pixels and how many are
confident; of the splat at the test views PSNR, SSIM, the share of pixels whose depth is off by more than 2 and 10 %, and haze:
the share of the blending weight that lies at least 2 % before or behind the true depth (bench/truth_bench.cpp). With --before, the differences from the runs of another folder stand in brackets.

  bench/kinds.py OUT                                                # all kinds, 8 of 24 views of 320 x 240
  bench/kinds.py OUT --before OUT_BEFORE                            # a change against runs of the program before it
  bench/kinds.py OUT --kinds thin,walls --views 5 --options "--iterations 1500 --seed 1" --scene "--width 160 --height 120"
"""

import argparse
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

BIN = Path(__file__).resolve().parent.parent / "build/release/bin/oraclegs"
KINDS = "room,object,walls,forward,thin,outdoor"
NUMBER = r" +(\S+) %"
STEREO = re.compile(rf"^stereo +all +confident{NUMBER} +median error{NUMBER}", re.M)
SPLAT = re.compile(rf"^splat +all .* over 2 %{NUMBER} +over 10 %{NUMBER} +haze before{NUMBER} +behind{NUMBER}", re.M)
COLUMNS = {  # heading: scores in it, each with its digits
    "stereo: median error / confident": {"stereo_error": 3, "confident": 1},
    "PSNR": {"psnr": 2},
    "SSIM": {"ssim": 4},
    "depth off by > 2 % / > 10 %": {"over_2": 2, "over_10": 2},
    "haze before / behind": {"before": 2, "behind": 2},
}
SHARES = {"stereo_error", "confident", "over_2", "over_10", "before", "behind"}  # in percent


def run(*words):
    """Whether a program succeeds; what it reports goes to stderr."""
    words = [str(word) for word in words]
    print("+", shlex.join(words), file=sys.stderr, flush=True)
    return subprocess.run(words, stdout=sys.stderr).returncode == 0


def reconstruct(out, kind, options):
    """Makes the scene and the run of a kind, as far as they are not there. False where that fails."""
    scene = out / "scenes" / kind
    if not (scene / "transforms.json").exists():  # which is written last
        if not run(options.program, "demo-scene", scene, "--quiet", "--kind", kind, *shlex.split(options.scene)):
            return False
    return run(options.program, "reconstruct", scene, "-o", out / "runs" / kind, "--quiet", "--eval", "--views", options.views,
               *shlex.split(options.options))  # fmt: skip


def truth_of(text):
    """The scores in what truth_bench prints."""
    found = {}
    if stereo := STEREO.search(text):
        found["confident"], found["stereo_error"] = map(float, stereo.groups())
    if splat := SPLAT.search(text):
        found["over_2"], found["over_10"], found["before"], found["behind"] = map(float, splat.groups())
    return found


def read(out, kind, truth_bench):
    """The scores of a finished run; none where there is no such run."""
    folder = out / "runs" / kind
    if not (folder / "metrics.json").exists():
        return {}
    test = json.loads((folder / "metrics.json").read_text())["test"]
    measured = subprocess.run([truth_bench, folder], capture_output=True, text=True)
    if measured.returncode:
        print(f"{folder}: {measured.stderr.strip()}; the table does without", file=sys.stderr)
    return {"psnr": test["psnr"], "ssim": test["ssim"], **truth_of(measured.stdout)}


def cell(scores, after, before):
    """A cell of the table; empty where a run has none of its scores."""
    words = []
    for score, digits in scores.items():
        if after.get(score) is None:
            words.append("")
            continue
        word = f"{after[score]:.{digits}f}" + (" %" if score in SHARES else "")
        if before.get(score) is not None:
            word += f" ({after[score] - before[score]:+.{digits}f})"
        words.append(word)
    return " / ".join(words) if any(words) else ""


def table(after, before):
    """Markdown of {kind: scores}, with the differences from those of before."""
    lines = ["| " + " | ".join(["kind", *COLUMNS]) + " |", "| --- " * (1 + len(COLUMNS)) + "|"]
    for kind, scores in after.items():
        cells = [cell(of, scores, before.get(kind, {})) for of in COLUMNS.values()]
        lines.append("| " + " | ".join([kind, *cells]) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder of the scenes and runs")
    parser.add_argument("--kinds", default=KINDS, help="default: %(default)s")
    parser.add_argument("--views", type=int, default=8, help="training views; default: %(default)s")
    parser.add_argument("--options", default="", help="options of `oraclegs reconstruct` for all kinds")
    parser.add_argument("--scene", default="", help="options of `oraclegs demo-scene`, where a scene is not there yet")
    parser.add_argument("--before", type=Path, help="another folder OUT to compare with")
    parser.add_argument("--program", type=Path, default=BIN, help="default: %(default)s")
    parser.add_argument("--truth-bench", type=Path, default=BIN.with_name("truth_bench"), help="default: %(default)s")
    options = parser.parse_args()
    options.kinds = options.kinds.split(",")
    if unknown := [kind for kind in options.kinds if kind not in KINDS.split(",")]:
        parser.error(f"--kinds names {', '.join(unknown)}; there are {KINDS}")
    after, failed = {}, []
    for kind in options.kinds:
        if reconstruct(options.out, kind, options):
            after[kind] = read(options.out, kind, options.truth_bench)
        else:
            failed.append(kind)
    before = {kind: read(options.before, kind, options.truth_bench) for kind in after} if options.before else {}
    print(table(after, before))
    if failed:
        sys.exit(f"{', '.join(failed)} failed; the last words of each stand above")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Kills a run at random moments of every stage; the same command must end it with the bits of an undisturbed run.

usage: kill_stages.py [--kills N] [--seed S] [--chain] [--real-colmap] [--generator]

Each kill is SIGKILL or SIGTERM, of the program alone or with its whole process group. --chain resumes into the next
kill, and to the end once all stages had one, which is quicker; without it each kill is resumed to the end. The table
counts by the stage that was hit: a stage that a kill came too late for is aimed at again. --real-colmap kills register
and sfm with the colmap that is installed. It finds other poses each time, so that there the same command must find
nothing left to do after the resumed run.
"""

import argparse
import os
import random
import shutil
import signal
import sys
import time

from lab import GRACE, STAGES, Broken, Lab, require, results, table

WAYS = [(signal.SIGKILL, False), (signal.SIGTERM, False), (signal.SIGKILL, True), (signal.SIGKILL, False)]
GENERATOR = ["--proposers", "both", "--generator", "sleep 0.1 & wait; cp {request}/warps/*.png {answer}/"]

REAL_SCENE = ["--demo-views", 10, "--width", 240, "--height", 180, "--samples", 1]  # which colmap can register


class Killer:
    def __init__(self, lab, numbers, given):
        self.lab, self.numbers, self.verbose = lab, numbers, given.verbose
        self.options = GENERATOR if given.generator else ["--max-size", 96] if given.real_colmap else []
        self.stages = ["register", "sfm"] if given.real_colmap else STAGES
        self.varies = given.real_colmap
        self.hits = {stage: {"SIGKILL": 0, "SIGTERM": 0, "same bits": 0} for stage in ["start", *STAGES]}
        self.reference, self.lengths = None, {}

    def learn(self):
        """An undisturbed run: its results, and how long each stage takes."""
        out = self.lab.dir / "undisturbed"
        run = self.lab.start(out, *self.options)
        code, text = run.wait()
        require(code == 0, text)
        order = [stage for stage in [*STAGES, "end"] if stage in run.begun]
        self.stages = [stage for stage in self.stages if stage in order]
        self.lengths = {a: run.begun[b] - run.begun[a] for a, b in zip(order, order[1:])}
        self.reference = results(out)
        self.lab.check_finished(out, self.reference)

    def kill(self, out, stage):
        """The stage that was hit; None when the run came to its end before."""
        how, whole_group = self.numbers.choice(WAYS)
        run = self.lab.start(out, *self.options, start_new_session=True)
        if run.wait_for(stage):
            time.sleep(self.numbers.random() * self.lengths[stage])
        self.lab.check_records(out)
        if whole_group:
            os.killpg(run.process.pid, how)
        else:
            run.process.send_signal(how)
        code, text = run.wait()
        if code == 0:
            return None
        require(code in (-how, 130), f"exit code {code}:\n{text}")
        require(code == (130 if how == signal.SIGTERM else -how) or run.stage == "start", f"{code}:\n{text}")
        self.lab.check_no_orphans()
        self.lab.check_surroundings()
        self.lab.check_records(out)
        self.hits[run.stage][how.name] += 1
        if self.verbose:
            print(f"{how.name} in {run.stage}{', the whole group' if whole_group else ''}", flush=True)
        return run.stage

    def resume(self, out, stages):
        self.lab.finish(out, *self.options)
        self.lab.check_no_orphans()
        self.lab.check_surroundings()
        if self.varies:
            self.reference = results(out)
            self.lab.finish(out, *self.options)
        self.lab.check_finished(out, self.reference)
        for stage in stages:
            self.hits[stage]["same bits"] += 1
        shutil.rmtree(out)

    def run_chain(self):
        """A kill in each stage of one run."""
        out, hit = self.lab.dir / "chain", []
        for stage in self.stages:
            hit.append(self.kill(out, stage))
        self.resume(out, filter(None, hit))

    def run_each(self, stage):
        out = self.lab.dir / "each"
        hit = self.kill(out, stage)
        self.resume(out, filter(None, [hit]))

    def missing(self, kills):
        return [stage for stage in self.stages if sum(list(self.hits[stage].values())[:2]) < kills]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--kills", type=int, default=8, help="of each stage")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--chain", action="store_true")
    parser.add_argument("--real-colmap", action="store_true", help="with the program that is installed")
    parser.add_argument("--verbose", action="store_true", help="print a line for each kill")
    parser.add_argument("--generator", action="store_true", help="with --generator, whose children must end, too")
    given = parser.parse_args()
    begin = time.monotonic()
    with Lab(scene=REAL_SCENE if given.real_colmap else None, real_colmap=given.real_colmap) as lab:
        killer = Killer(lab, random.Random(given.seed), given)
        killer.learn()
        try:
            for _ in range(given.kills if given.chain else 0):
                killer.run_chain()
            for _ in range(20 * given.kills):
                for stage in killer.missing(given.kills):
                    killer.run_each(stage)
                if not killer.missing(given.kills):
                    break
        except Broken as broken:
            sys.exit(f"kill_stages.py --seed {given.seed}: {broken}")
        rows = [(stage, *hits.values()) for stage, hits in killer.hits.items() if stage != "start" or any(hits.values())]
        totals = [sum(column) for column in list(zip(*rows))[1:]]
        print(table([*rows, ("all", *totals)], ["stage", "SIGKILL", "SIGTERM", "same bits"]))
        print(f"{totals[0] + totals[1]} kills, orphans after {GRACE} s: 0, {time.monotonic() - begin:.0f} s")
        if killer.missing(given.kills):
            sys.exit(f"kill_stages.py: too few kills of {killer.missing(given.kills)}")


if __name__ == "__main__":
    main()

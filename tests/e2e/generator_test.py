"""--generator from the outside: a stand-in program, what it may do wrong, and the example that ships."""

import json
import shlex
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

from constant_generator import COLOR, read_png
from harness import ROOT, ManyViews, command, files_below, main

RUN = ["--views", 10, "--test-every", 4, "--set", "stereo-iterations=3", "--set", "stereo-passes=1", "--iterations", 20,
       "--max-gaussians", 1500, "--set", "proxy-models=3", "--trajectory", "dataset"]  # fmt: skip
EXAMPLE = ROOT / "examples/generators/inpaint_holes"
STAND_IN = f"{shlex.quote(sys.executable)} {shlex.quote(str(Path(__file__).with_name('constant_generator.py')))}"


class Generator(ManyViews):
    def arguments(self, out, generator, *more):
        return [self.scene, "-o", out, *RUN, "--proposers", "command", "--generator", generator, *more]

    def frames(self, out):
        return json.loads((out / "proposals/transforms.json").read_text())["frames"]

    def test_its_images_are_validated_and_trained_on(self):
        out = self.dir / "out with blanks"
        generator = STAND_IN + " {request} {answer} slow"
        done = self.run_program("reconstruct", *self.arguments(out, generator))
        self.assertRegex(done.stderr, r"propose: .*3/5 generated views \(60%\)")
        names = [frame["file_path"] for frame in self.frames(out)]
        self.assertEqual(len(names), 5)
        filled = 0
        for name in names:
            _, _, mask = read_png(out / "proposals/generator/request/masks" / name)
            _, _, image = read_png(out / "proposals/command" / name)
            _, _, warp = read_png(out / "proposals/generator/request/warps" / name)
            for y, row in enumerate(mask):
                for x, known in enumerate(row):
                    pixel = tuple(image[y][3 * x : 3 * x + 3])
                    self.assertEqual(pixel, tuple(warp[y][3 * x : 3 * x + 3]) if known else COLOR)
                    filled += known == 0
            self.assertTrue((out / "confidence" / name).is_file())
            self.assertFalse((out / "proposals/warp" / name).exists())
        self.assertGreater(filled, 0)
        before = files_below(out / "proposals")
        self.run_program("validate", *self.arguments(out, generator))
        self.assertEqual(files_below(out / "proposals"), before, "made once")

    def test_it_takes_part_beside_the_other_proposers(self):
        out = self.dir / "beside"
        generator = STAND_IN + ' "$ORACLEGS_REQUEST" "$ORACLEGS_ANSWER"'
        self.run_program("propose", self.scene, "-o", out, *RUN, "--proposers", "proxies,warp", "--generator", generator)
        for frame in self.frames(out):
            for folder in ("warp", "proxies", "command"):
                self.assertTrue((out / "proposals" / folder / frame["file_path"]).is_file(), folder)

    def test_what_goes_wrong_is_one_line_that_says_how_to_fix_it(self):
        out = self.dir / "wrong"
        request = out / "proposals/generator/request"

        def error_of(fault, *more, **expected):
            return self.error_of("propose", *self.arguments(out, f"{STAND_IN} {{request}} {{answer}} {fault}", *more), **expected)

        error_of("fail", code=4, names=["exit code 7", "the network has no memory", "log.txt"])
        second = json.loads((request / "transforms.json").read_text())["frames"][1]["file_path"]
        answer = out / "proposals/generator/answer" / second
        error_of("missing", code=3, names=[answer, "is missing (1 of 5", request / "transforms.json"])
        error_of("size", code=3, names=[answer, "is 80 x 59, its pose is for 80 x 60", "w and h"])
        error_of("hang", "--generator-timeout", 2, code=4, names=["stopped after 2 s, when 1 of 5", "--generator-timeout"])
        self.run_program("propose", *self.arguments(out, STAND_IN + " {request} {answer}"))

    def test_options_that_contradict_each_other(self):
        out = ["-o", self.dir / "options"]
        self.error_of("propose", self.scene, *out, "--proposers", "command", code=2, names=["--generator"])
        self.error_of("propose", self.scene, *out, "--proposers", "none", "--generator", "true", code=2,
                      names=["--proposers command"])  # fmt: skip

    def test_an_interrupt_ends_the_program_and_its_children(self):
        out, pid = self.dir / "interrupted", self.dir / "pid"
        arguments = self.arguments(out, f"sh -c 'echo $$ > {pid}; exec sleep 600'; true")
        with subprocess.Popen(command("propose", *arguments), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as run:
            for _ in range(3000):
                if pid.exists() and pid.read_text():
                    break
                time.sleep(0.1)
            run.send_signal(signal.SIGINT)
            run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130)
        stat = Path(f"/proc/{pid.read_text().strip()}/stat")
        for _ in range(100):
            state = stat.read_text().rpartition(")")[2].split()[0] if stat.exists() else "Z"
            if state == "Z":
                break
            time.sleep(0.1)
        self.assertEqual(state, "Z", "it lives on")

    def test_inpaint_holes_fills_holes_and_nothing_else(self):
        self.assertTrue((EXAMPLE / "node_modules").is_dir(),
                        f"the example's packages are not installed: run scripts/test.sh once, or npm ci --prefix {EXAMPLE}")  # fmt: skip
        out = self.dir / "inpainted"
        generator = f"node {shlex.quote(str(EXAMPLE / 'fill.mjs'))} {{request}} {{answer}}"
        self.run_program("validate", *self.arguments(out, generator))
        changed = kept = 0
        for frame in self.frames(out):
            name = frame["file_path"]
            self.assertTrue((out / "confidence" / name).is_file())
            _, _, mask = read_png(out / "proposals/generator/request/masks" / name)
            _, _, warp = read_png(out / "proposals/generator/request/warps" / name)
            _, _, image = read_png(out / "proposals/command" / name)
            for y, row in enumerate(mask):
                for x, known in enumerate(row):
                    same = warp[y][3 * x : 3 * x + 3] == image[y][3 * x : 3 * x + 3]
                    self.assertTrue(same or not known, "a pixel that was known has changed")
                    changed += not same
                    kept += known > 0
        self.assertGreater(changed, 0)
        self.assertGreater(kept, 0)


if __name__ == "__main__":
    main()

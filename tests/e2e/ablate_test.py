"""The ablation from the outside: its table, its files, what it refuses."""

import json
import re
import unittest

from harness import EndToEnd, files_below, main

RUN = ["--stereo-iterations", 3, "--stereo-passes", 1, "--iterations", 20, "--max-gaussians", 1000, "--random-points",
       800, "--test-every", 4]  # fmt: skip


class Ablate(EndToEnd):
    def test_prints_a_table_and_writes_it(self):
        out = self.dir / "an ablation"
        arguments = ["ablate", self.scene, "-o", out, *RUN, "--rows", "mcmc,proposals", "--seeds", 2, "--seed", 3]
        done = self.run_program(*arguments)
        self.assertRegex(done.stdout, r"(?m)^1 MCMC, random start +\d+\.\d\d ± \d+\.\d\d +0\.\d{4} ± ")
        self.assertRegex(done.stdout, r"(?m)^2 \+ proposals .* [+-]\d+\.\d\d ± \d+\.\d\d +\d+:\d\d$")
        self.assertRegex(done.stderr, r"row 1 of 11 \(MCMC, random start\), seed 3: \d+\.\d\d dB, about [0-9:]+ left")
        report = json.loads((out / "ablation.json").read_text())
        self.assertEqual(report["seeds"], [3, 4])
        for row in report["rows"]:
            for run in row["runs"]:
                metrics = json.loads((out / run["workspace"] / "metrics.json").read_text())
                self.assertEqual(metrics["test"]["psnr"], run["psnr"])
                self.assertEqual(metrics["seed"], run["seed"])
        document = (out / "ablation.md").read_text()
        self.assertIn(f"    oraclegs ablate {self.scene} -o '{out}' --stereo-iterations 3 ", document)
        table = [line for line in document.splitlines() if re.match(r"\| \d [^|]*\| \d+\.\d\d ± ", line)]
        self.assertEqual(len(table), 2)

        rows = files_below(out / "rows")
        self.assertEqual(self.run_program(*arguments).stdout, done.stdout)
        again = files_below(out / "rows")
        same = {name for name in rows if name.endswith((".ply", "metrics.json", "stages.json", ".png"))}
        self.assertEqual({name: again[name][0] for name in same}, {name: rows[name][0] for name in same})

    def test_bad_input(self):
        out = self.dir / "refused"
        self.error_of("ablate", self.scene, code=2, names=["-o"])
        self.error_of("ablate", self.scene, "-o", out, "--rows", "mcmc,magic", code=2, names=["--rows", "magic", "mcmc"])
        self.error_of("ablate", self.scene, "-o", out, "--seeds", 0, code=2, names=["--seeds"])
        self.error_of("ablate", self.scene, "-o", out, "--init", "sfm", code=2, names=["--init"])
        self.error_of("ablate", self.scene, "-o", out, "--proposers", "none", code=2, names=["--proposers"])
        self.error_of("ablate", self.dir / "nowhere", "-o", out, code=3, names=["nowhere"])
        self.assertFalse(out.exists())


if __name__ == "__main__":
    main()

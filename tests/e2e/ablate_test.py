"""The ablation from the outside: its table, its files, what it refuses."""

import json
import re
import subprocess
import unittest

from harness import EndToEnd, command, files_below, main, read_png

RUN = ["--set", "stereo-iterations=3", "--set", "stereo-passes=1", "--iterations", 20, "--max-gaussians", 1000, "--set",
       "random-points=800", "--test-every", 4]  # fmt: skip


class Ablate(EndToEnd):
    def test_prints_a_table_and_writes_it(self):
        out = self.dir / "an ablation"
        arguments = ["ablate", self.scene, "-o", out, *RUN, "--rows", "mcmc,union", "--seeds", 2, "--seed", 3]
        done = self.run_program(*arguments)
        self.assertRegex(done.stdout, r"(?m)^1 MCMC, random start +\d+\.\d\d ± \d+\.\d\d +0\.\d{4} ± ")
        self.assertRegex(done.stdout, r"(?m)^2 \+ all proposals .* [+-]\d+\.\d\d ± \d+\.\d\d +\d+:\d\d$")
        self.assertRegex(done.stderr, r"row 1 of 11 \(MCMC, random start\), seed 3: \d+\.\d\d dB, about [0-9:]+ left")
        report = json.loads((out / "ablation.json").read_text())
        self.assertEqual(report["seeds"], [3, 4])
        for row in report["rows"]:
            for run in row["runs"]:
                metrics = json.loads((out / run["workspace"] / "metrics.json").read_text())
                self.assertEqual(metrics["test"]["psnr"], run["psnr"])
                self.assertEqual(metrics["seed"], run["seed"])
        document = (out / "ablation.md").read_text()
        self.assertIn(f"    oraclegs ablate {self.scene} -o '{out}' --set stereo-iterations=3 ", document)
        table = [line for line in document.splitlines() if re.match(r"\| \d [^|]*\| \d+\.\d\d ± ", line)]
        self.assertEqual(len(table), 2)

        rows = files_below(out / "rows")
        self.assertEqual(self.run_program(*arguments).stdout, done.stdout)
        again = files_below(out / "rows")
        same = {name for name in rows if name.endswith((".ply", "metrics.json", "stages.json", ".png"))}
        self.assertEqual({name: again[name][0] for name in same}, {name: rows[name][0] for name in same})

    def test_several_scenes_and_lists_in_files(self):
        other = self.copy_scene("other")
        split = self.dir / "split.txt"
        split.write_text("\n".join(f":{i}" for i in range(1, 8)))
        out = self.dir / "suite"
        rows = [*RUN, "--rows", "mcmc", "--seeds", 1]
        arguments = ["ablate", self.scene, "-o", out, *rows, "--also", other, "--train-views", f"@{split}",
                     "--test-views", ":0"]  # fmt: skip
        done = self.run_program(*arguments)
        self.assertIn("mean over scene, other: 20 iterations", done.stdout)
        self.assertEqual(self.run_program(*arguments).stdout, done.stdout, "goes on where it was")
        refused = self.dir / "refused_suite"
        suite = ["ablate", self.scene, "-o", refused, *rows, "--also"]
        self.error_of(*suite, self.dir / "nowhere", code=3, names=["nowhere"])
        self.error_of(*suite, self.scene, code=2, names=["two scenes"])
        self.assertFalse(refused.exists())

    def test_bad_input(self):
        out = self.dir / "refused"
        self.error_of("ablate", self.scene, code=2, names=["-o"])
        self.error_of("ablate", self.scene, "-o", out, "--rows", "mcmc,magic", code=2, names=["--rows", "magic", "mcmc"])
        self.error_of("ablate", self.scene, "-o", out, "--seeds", 0, code=2, names=["--seeds"])
        self.error_of("ablate", self.scene, "-o", out, "--init", "random", code=2, names=["--init"])
        self.error_of("ablate", self.scene, "-o", out, "--proposers", "none", code=2, names=["--proposers"])
        self.error_of("ablate", self.dir / "nowhere", "-o", out, code=3, names=["nowhere"])
        self.assertFalse(out.exists())


class Tampering(EndToEnd):
    # Long enough that there is something to tamper with, and a dose that makes lies felt.
    RUN = ["--compare", "tampering", "--views", 10, "--test-every", 4, "--set", "stereo-iterations=3", "--set", "stereo-passes=1",
           "--iterations", 300, "--max-gaussians", 3000, "--set", "proxy-models=2", "--set", "proxy-share=0.6", "--set",
           "synthetic-floor=0.4"]  # fmt: skip

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.dir / "views"
        size = ["--demo-views", 24, "--width", 128, "--height", 96, "--samples", 1]
        subprocess.run(command("demo-scene", cls.scene, "--quiet", *size), check=True)

    def test_prints_a_table_and_keeps_what_is_tampered_with(self):
        out = self.dir / "tampering"
        arguments = ["ablate", self.scene, "-o", out, *self.RUN, "--seeds", 1, "--seed", 2, "--shares", "0,30,100"]
        done = self.run_program(*arguments)
        psnr = r" +\d+\.\d\d"
        for share in (0, 30, 100):
            self.assertRegex(done.stdout, rf"(?m)^ *{share} %{4 * psnr} ")
        self.assertRegex(done.stdout, r"(?m)^Worst of oracle − none: [+-]\d+\.\d\d dB$")
        self.assertRegex(done.stderr, r"share-30-uniform, seed 2: \d+\.\d\d dB, about [0-9:]+ left")

        report = json.loads((out / "tampering.json").read_text())
        self.assertEqual([share["percent"] for share in report["shares"]], [0, 30, 100])
        honest, some, everything = report["shares"]
        for run in report["none"] + some["runs"]:
            metrics = json.loads((out / run["workspace"] / "metrics.json").read_text())
            self.assertEqual((metrics["test"]["psnr"], metrics["seed"]), (run["psnr"], run["seed"]))
        self.assertEqual(honest["psnr"]["ideal"], honest["psnr"]["uniform"])
        self.assertEqual(everything["psnr"]["ideal"], everything["psnr"]["none"])
        self.assertGreaterEqual(some["confidence"][0]["tampered"], 0.3)
        self.assertGreater(some["auroc"], 0.75)
        for share in (some, everything):
            self.assertGreater(share["psnr"]["oracle"]["mean"], share["psnr"]["uniform"]["mean"], share["percent"])
        self.assertIn("| 30 % | ", (out / "tampering.md").read_text())
        self.assertIn("</svg>", (out / "tampering.svg").read_text())

        pictures = out / "tampered/seed-2"
        tampered = pixels = 0
        for path in sorted((pictures / "share-30/masks").iterdir()):
            mask = read_png(path)[3]
            lie, truth = (read_png(pictures / share / "pictures" / path.name)[3] for share in ("share-30", "share-0"))
            ideal = read_png(pictures / "share-30/ideal/confidence" / path.name)[3]
            self.assertEqual(bytes(255 - value for value in mask), bytes(ideal))
            for i, value in enumerate(mask):
                difference = max(abs(lie[c] - truth[c]) for c in range(3 * i, 3 * i + 3))
                self.assertTrue(difference >= 12 if value else difference <= 14, "0.05 and the rounding to 8 bits")
            tampered += sum(map(bool, mask))
            pixels += len(mask)
        self.assertAlmostEqual(some["confidence"][0]["tampered"], tampered / pixels)

        kept = files_below(out / "tampered")
        self.assertEqual(self.run_program(*arguments).stdout, done.stdout)
        self.assertEqual(files_below(out / "tampered"), kept)

    def test_bad_input(self):
        out = self.dir / "refused"
        compare = ["ablate", self.scene, "-o", out, "--compare"]
        self.error_of(*compare, "magic", code=2, names=["--compare is 'magic'", "parts, tampering"])
        self.error_of(*compare, "tampering", "--shares", "10,lots", code=2, names=["--shares names 'lots'"])
        self.error_of(*compare, "tampering", "--shares", "120", code=2, names=["--shares names '120'", "0 .. 100"])
        self.error_of(*compare, "tampering", "--rows", "mcmc", code=2, names=["--rows"])
        self.error_of(*compare, "tampering", "--proposers", "warp", code=2, names=["--proposers"])
        self.error_of(*compare, "parts", "--shares", "10", code=2, names=["--shares"])
        self.assertFalse(out.exists())


if __name__ == "__main__":
    main()

"""The presets: those of the paper hold the paper's settings, as docs/method.md lists them, and all of them can be read."""

import re
import tomllib
import unittest
from pathlib import Path

from harness import ROOT, EndToEnd, main

PRESETS = sorted((ROOT / "presets").glob("*.toml"))
# A line or an equation of the paper, a file of its authors or of the code that they build on; or the list below the table.
SOURCE = r"^(Blender: )?(L\d+|eq\. \d|((mcmc|seva|3dgs) )?`[a-z_]+(\.py)?`|`README.md`|ours, see below)([,;] |$)"
PAPER = ["paper-mipnerf360-12", "paper-mipnerf360-24", "paper-blender-8", "paper"]


def preset(name):
    return tomllib.loads((ROOT / f"presets/{name}.toml").read_text())


def defaults():
    """{option: default} of `reconstruct`, as docs/commands.md lists them; another test compares that page with the program."""
    page = re.split(r"(?m)^## [\w ]+ options$", (ROOT / "docs/commands.md").read_text(), maxsplit=1)[1]
    rows = re.findall(r"^\| `(?:--)?([a-z0-9-]+)[^`]*` \|.*?default ([^|]*?) \|$", page, re.M)
    return dict(rows)


def word(value):
    return {True: "on", False: "off"}.get(value, str(value)) if isinstance(value, bool) else str(value)


def same(a, b):
    try:
        return float(a) == float(b)
    except ValueError:
        return a == b


class Presets(EndToEnd):
    def test_the_papers_are_the_paper(self):
        text = (ROOT / "docs/method.md").read_text().partition("\n## paper presets\n")[2].partition("\n## ")[0]
        rows = re.findall(r"^\| (.+?) \| (.+?) \| (.+?) \| `--(?:set )?([a-z0-9-]+)` \| (\S+) \| (\S+) \| (\S+) \| (\S+) \|$", text, re.M)
        self.assertEqual(len(rows), len(re.findall(r"(?m)^\| .*`--", text)))
        usual = defaults()
        given = [preset(name) for name in PAPER]
        for setting, paper, source, option, *expected in rows:
            self.assertRegex(source, SOURCE, setting)
            have = [word(p.get(option, usual.get(option, "nothing"))) for p in given]
            print(f"{setting:52} {paper:38} --{option:20} {' '.join(f'{h:14}' for h in have)}")
            for name, want, is_there in zip(PAPER, expected, have, strict=True):
                with self.subTest(preset=name, setting=setting):
                    self.assertTrue(same(want, is_there), f"--{option} is {is_there}, the paper's is {want}")
        listed = {option for _, _, _, option, *_ in rows}
        for name, options in zip(PAPER, given, strict=True):
            self.assertEqual(set(options) - listed - {"train-views", "test-views", "force"}, set(), f"{name}: not in the table")

    def test_own_photos_get_all_that_is_no_datasets(self):
        own, dataset = preset("paper"), preset("paper-mipnerf360-12")
        self.assertEqual({option for option, value in dataset.items() if own.get(option) != value},
                         {"views", "test-every", "resize", "downscale", "smaller-copies", "trajectory", "proposals", "frame",
                          "sfm-points", "force"})  # fmt: skip
        self.assertEqual(set(own) - set(dataset), set())

    def test_published_splits(self):
        blender = preset("paper-blender-8")
        train = [int(name.rpartition("_")[2]) for name in blender["train-views"].split(",")]
        self.assertEqual(train, [26, 86, 2, 55, 75, 93, 16, 73])
        self.assertEqual(blender["test-views"].split(","), [f"test/r_{i}" for i in range(0, 200, 8)])
        self.assertEqual([blender[k] for k in ("train-views", "test-views")],
                         [preset("best-blender-8")[k] for k in ("train-views", "test-views")])  # fmt: skip
        order = [25, 22, 28, 40, 44, 48, 0, 8, 13]
        for n in (3, 6, 9):
            self.assertEqual([preset(f"llff-{n}")[key] for key in ("views", "test-every", "view-steps")], [n, 8, "round"])
            dtu = preset(f"dtu-{n}")
            self.assertEqual(dtu["train-views"], ",".join(f":{i}" for i in order[:n]))
            test = [int(word[1:]) for word in dtu["test-views"].split(",")]
            self.assertEqual(len(test), 25)
            self.assertFalse(set(test) & set(order))

    def test_all_can_be_read(self):
        page = (ROOT / "docs/commands.md").read_text()
        for path in PRESETS:
            with self.subTest(path.stem):
                error = self.error_of("reconstruct", self.dir / "nowhere", "-o", self.dir / "out", "--preset", path.stem,
                                      "--allow-fallback", code=3)  # fmt: skip
                self.assertIn("nowhere", error)
                self.assertTrue(f"`{path.stem}`" in page, "not in docs/commands.md")


if __name__ == "__main__":
    main()

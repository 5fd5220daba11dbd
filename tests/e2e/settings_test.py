#!/usr/bin/env python3
"""--set: experts' settings. Few options of `reconstruct` are flags, all others are settings, and both are named alike in files."""

import json
import re

from harness import SMALL_RUN, EndToEnd, main

MOST_FLAGS = 60


def flags(text):
    return re.findall(r"(?m)^  (?:-\w, )?--([a-z-]+)", text)


def settings(text):
    return re.findall(r"(?m)^  ([a-z-]+)=", text.partition("\nExample:\n")[0])


class Settings(EndToEnd):
    def saved(self, name):
        return json.loads((self.dir / name / "options.json").read_text())["options"]

    def test_each_option_is_a_flag_or_a_setting(self):
        long_help = self.run_program("reconstruct", "--help-all").stdout
        have_flags, have_settings = flags(long_help), settings(self.run_program("help", "settings").stdout)
        print(f"{len(have_flags)} flags, {len(have_settings)} settings")
        self.assertLessEqual(len(have_flags), MOST_FLAGS)
        self.assertEqual(len(set(have_flags)), len(have_flags))
        self.assertEqual(len(set(have_settings)), len(have_settings))
        self.assertEqual(set(have_flags) & set(have_settings), set())
        self.assertIn("oraclegs help settings", long_help)
        self.run_program("sfm", self.scene, "-o", self.dir / "all", *SMALL_RUN)
        self.assertEqual(set(self.saved("all")) - set(have_flags) - set(have_settings), set())

    def test_set_means_what_a_file_does(self):
        file = self.dir / "settings.toml"
        file.write_text('ssim-weight = 0.3\ninit-planes = false\ndepth-loss = "paper"\niterations = 30\n')
        setting = ["--set", "ssim-weight=0.3", "--set", "init-planes=false", "--set", "depth-loss=paper", "--set", "iterations=30"]
        self.run_program("sfm", self.scene, "-o", self.dir / "file", "--init", "random", "--config", file)
        self.run_program("sfm", self.scene, "-o", self.dir / "set", "--init", "random", *setting)
        self.assertEqual(self.saved("file"), self.saved("set"))
        self.assertEqual([self.saved("set")[name] for name in ("ssim-weight", "init-planes", "iterations")], [0.3, False, 30])
        self.run_program("sfm", self.scene, "-o", self.dir / "wins", "--init", "random", "--config", file, "--set", "ssim-weight=0.1",
                         "--set", "ssim-weight=0.4")  # fmt: skip
        self.assertEqual(self.saved("wins")["ssim-weight"], 0.4, "the last of two, before the file")

    def test_mistakes_are_named(self):
        run = ["reconstruct", self.scene, "-o", self.dir / "none"]
        for words, names in [
            (["--set", "ssim-wieght=0.3"], ["ssim-wieght", "did you mean 'ssim-weight'?"]),
            (["--set", "zzzzzzzzz=1"], ["zzzzzzzzz", "oraclegs help settings"]),
            (["--set", "ssim-weight=7"], ["--set ssim-weight is 7", "0 .. 1"]),
            (["--set", "views=-1"], ["--views is -1", "0 .. "]),
            (["--set", "ssim-weight=much"], ["--set ssim-weight is 'much'", "a number"]),
            (["--set", "depth-loss=papper"], ["did you mean 'paper'?"]),
            (["--set", "ssim-weight"], ["--set ssim-weight=VALUE"]),
            (["--iterations", 5, "--set", "iterations=6"], ["--iterations", "one option"]),
            (["--ssim-weight", "0.3"], ["--ssim-weight", "--set ssim-weight=0.3"]),
            (["--ssim-weight=0.3"], ["--set ssim-weight=0.3"]),
            (["--no-init-planes"], ["--set init-planes=false"]),
            (["--set"], ["--set"]),
        ]:
            with self.subTest(words):
                self.error_of(*run, *words, code=2, names=names)
        line = self.error_of("render", self.dir / "none", "--set", "ssim-weight=1", code=2, names=["--set ssim-weight", "render has no use for it"])
        self.assertNotIn("did you mean", line)
        self.assertFalse((self.dir / "none").exists())


if __name__ == "__main__":
    main()

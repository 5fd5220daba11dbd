#!/usr/bin/env python3
"""The command line as a user meets it: help, documents, options from files, and the main job with its files."""

import json
import os
import re
import shutil
import struct
import subprocess
import unittest
from pathlib import Path

from harness import ROOT, SMALL_RUN, EndToEnd, command, files_below, main

COMMANDS = ["reconstruct", "sfm", "depth", "propose", "validate", "train", "evaluate", "bench", "ablate", "render", "figure", "export", "convert", "mesh", "cameras",
            "view", "info", "doctor", "models", "demo", "demo-scene", "help", "completion", "man"]  # fmt: skip

# Headers below src/oraclegs that declare options: all of a run, and those of single commands.
RUN_OPTIONS = ["settings/options.h", "capture/import.h", "scene/split.h", "scene/loaded_view.h", "depth/stereo.h", "train/options.h",
               "propose/options.h", "propose/trajectory.h", "validate/options.h", "networks/seva_options.h"]
OWN_OPTIONS = {"ablate": "experiments/ablation.h", "bench": "experiments/bench/bench_plan.h", "render": "output/render_path.h", "figure": "output/figures/figure.h", "export": "output/export.h", "convert": "output/export.h",
               "mesh": "mesh/fuse_model.h", "demo": "demo/demo_scene.h", "demo-scene": "demo/demo_scene.h", "view": "../../apps/oraclegs/viewing.h", "models": "weights/fetch.h"}  # fmt: skip

# Headers of run options that a command has no use for.
NOT_SHOWN = {
    "bench": ["capture/import.h"],
    "cameras": [header for header in RUN_OPTIONS if header not in ("scene/split.h", "scene/loaded_view.h")],
    "sfm": ["depth/stereo.h", "train/options.h", "propose/options.h", "propose/trajectory.h", "validate/options.h", "networks/seva_options.h"],
    "depth": ["train/options.h", "propose/options.h", "propose/trajectory.h", "validate/options.h", "networks/seva_options.h"],
    "propose": ["validate/options.h"],
    **{name: ["capture/import.h", "depth/stereo.h", "propose/options.h", "propose/trajectory.h", "validate/options.h", "networks/seva_options.h"]
       for name in ["evaluate", "render", "figure", "mesh"]},
    **{name: RUN_OPTIONS for name in ["export", "convert", "view", "info", "doctor", "models", "demo", "demo-scene", "help", "completion", "man"]},
}

# Of these headers, what single commands have nevertheless.
SHOWN_ALONE = {"demo-scene": {"threads"}, "info": {"max-megapixels"}} | {name: {"antialiased"} for name in ["evaluate", "render", "figure", "mesh"]} | {
    "demo": {"threads", "views", "iterations"}, "cameras": {"images", "poses", "frame", "allow-outside"}}

BASIC = ["out", "quality", "max-size", "eval", "frames", "preset", "config", "views", "iterations", "device", "seed", "view", "overwrite", "quiet", "help"]  # of reconstruct


def declared_options(headers, settings=False):
    """The flags that the headers declare, or their settings."""
    for header in headers:
        for name, rest in re.findall(r'visit\(\s*"([a-z-]+)"(.*?)\);\n', (ROOT / "src/oraclegs" / header).read_text(), re.S):
            if ("Tier::kSetting" in rest) == settings:
                yield name


def options_in(text):
    return re.findall(r"(?m)^  (?:-\w, )?--([a-z-]+)", text)


class Help(unittest.TestCase):
    def output_of(self, *arguments):
        return subprocess.run(command(*arguments), check=True, capture_output=True, text=True).stdout

    def test_lists_every_command(self):
        text = self.output_of("--help")
        for name in COMMANDS:
            self.assertRegex(text, rf"(?m)^  {name} +\w")
        self.assertIn("Usage: oraclegs COMMAND", text)
        self.assertEqual(text, self.output_of("help"))

    def test_all_of_a_command_has_what_it_uses_with_default_and_an_example(self):
        for name in COMMANDS:
            text = self.output_of(name, "--help-all")
            flat = " ".join(text.split())
            shown = [OWN_OPTIONS[name]] if name in OWN_OPTIONS else []
            shown += [header for header in RUN_OPTIONS if header not in NOT_SHOWN.get(name, [])]
            of_stages = [header for header in shown if header not in ("settings/options.h", "train/options.h")]
            for option in declared_options(shown if name == "reconstruct" else of_stages):
                self.assertRegex(flat, rf"--{option}\b[^\[]*\[[^\]]*default", f"{name} --{option}")
            self.assertIn("Example:", text)
            self.assertIn(f"Usage: oraclegs {name} [OPTIONS]", text)
            self.assertLess(max(map(len, text.splitlines())), 121)

    def test_the_help_of_settings_has_each_with_its_default(self):
        text = self.output_of("help", "settings")
        flat = " ".join(text.split())
        for option in declared_options(RUN_OPTIONS, settings=True):
            self.assertRegex(flat, rf" {option}=[^\[]*\[[^\]]*default", option)
        self.assertLess(max(map(len, text.splitlines())), 121)

    def test_a_command_shows_nothing_that_it_has_no_use_for(self):
        for name, headers in NOT_SHOWN.items():
            own = set(declared_options([OWN_OPTIONS[name]])) if name in OWN_OPTIONS else set()
            shown = set(options_in(self.output_of(name, "--help-all")))
            self.assertEqual(shown & set(declared_options(headers)) - own - SHOWN_ALONE.get(name, set()), set(), name)

    def test_the_short_help_is_short_and_says_where_the_rest_is(self):
        text = self.output_of("reconstruct", "--help")
        options = options_in(text)
        self.assertLessEqual(len(re.findall(r"(?m)^  -", text)), 15)
        for name in BASIC:
            self.assertIn(name, options)
        self.assertRegex(text, r"(?m)^\d+ more options: oraclegs reconstruct --help-all$")
        for name in COMMANDS:
            short = self.output_of(name, "--help")
            self.assertLessEqual(len(options_in(short)), 17, name)
            self.assertLessEqual(set(options_in(short)), set(options_in(self.output_of(name, "--help-all"))))

    def test_the_help_command_explains_another(self):
        self.assertEqual(self.output_of("help", "export"), self.output_of("export", "--help"))
        self.assertEqual(self.output_of("help", "sfm", "--all"), self.output_of("sfm", "--help-all"))

    def test_the_help_of_preset_names_all(self):
        text = " ".join(self.output_of("reconstruct", "--help").split())
        for preset in (ROOT / "presets").glob("*.toml"):
            self.assertIn(preset.stem, text)

    def test_version(self):
        text = self.output_of("--version")
        self.assertRegex(text, r"^oraclegs \d+\.\d+\.\d+ \(commit ([0-9a-f]{7,40}(-dirty)?|unknown)\)\n")
        for line in ["cpu .* in use \\(.* built\\), \\d+ threads?", "cuda .*", "libtorch .*", "colmap .*", "ffmpeg .*"]:
            self.assertRegex(text, rf"(?m)^{line}$")
        self.assertEqual(len(text.splitlines()), 6)

    def test_the_doctor_says_what_is_missing_and_how_to_get_it(self):
        def doctor(*arguments, **variables):
            return subprocess.run(command("doctor", *arguments), env={**os.environ, **variables}, capture_output=True, text=True, check=True).stdout

        def found(**variables):
            report = json.loads(doctor("--json", **variables))
            self.assertTrue(report["program"].startswith("oraclegs "))
            return {finding["name"]: finding for finding in report["findings"]}

        here = found()
        self.assertTrue(here["colmap"]["here"])
        self.assertRegex(here["colmap"]["found"], r"^[0-9]+\.[0-9]+")
        self.assertIn("GB", here["memory"]["found"])
        self.assertFalse(here["weights"]["here"])  # of the tests
        bare = found(PATH="/nonexistent")
        for name in ("colmap", "ffmpeg"):
            self.assertFalse(bare[name]["here"])
            self.assertEqual(bare[name]["found"], "not found")
            self.assertEqual(bare[name]["advice"], f"apt install {name}")
        homeless = {name: value for name, value in os.environ.items() if name not in ("HOME", "ORACLEGS_MODELS")}
        lines = subprocess.run(command("doctor"), env=homeless, capture_output=True, text=True, check=True).stdout
        self.assertRegex(lines, r"(?m)^missing +weights .*HOME")
        self.assertRegex(doctor(PATH="/nonexistent"), r"(?m)^missing +colmap +not found$")

    def test_documents_name_every_preset(self):
        pages = (ROOT / "docs/tutorial.md").read_text() + (ROOT / "docs/commands.md").read_text()
        for preset in (ROOT / "presets").glob("*.toml"):
            self.assertIn(f"`{preset.stem}`", pages)

    def test_program_links_no_libtorch(self):
        program = command("--version")[0]
        libraries = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
        self.assertIn("liboraclegs_core", libraries)
        for name in ["libtorch", "libc10", "openblas"]:  # not "c10", which addresses may hold
            self.assertNotIn(name, libraries)

    def test_program_knows_no_folder_of_its_sources(self):
        program = Path(command("--version")[0]).read_bytes()
        for folder in ["presets", "scripts"]:
            self.assertNotIn(str(ROOT / folder).encode(), program)


class Shell(unittest.TestCase):
    def complete(self, *words):
        """What bash offers for the last of these words."""
        words = " ".join(f"'{word}'" for word in ["oraclegs", *words])
        script = f'source <("$1" completion bash); COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); ' \
                 '$(complete -p oraclegs | sed "s/.*-F \\([^ ]*\\).*/\\1/"); printf "%s\\n" "${COMPREPLY[@]}"'  # fmt: skip
        done = subprocess.run(["bash", "-c", script, "bash", command()[0]], capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def test_bash_completes_commands_options_and_words(self):
        self.assertEqual(self.complete("recon"), ["reconstruct"])
        self.assertEqual(self.complete("reconstruct", "--iter"), ["--iterations"])
        self.assertEqual(self.complete("reconstruct", "x", "--preset", "paper-bl"), ["paper-blender-8"])
        self.assertIn("hybrid", self.complete("sfm", "--init", ""))
        self.assertEqual(self.complete("help", "expo"), ["export"])
        self.assertEqual(self.complete("export", "--iter"), [])
        self.assertEqual(self.complete("reconstruct", "--views", ""), [])

    def test_other_shells_have_every_command_and_option(self):
        for shell in ["zsh", "fish"]:
            text = subprocess.run(command("completion", shell), check=True, capture_output=True, text=True).stdout
            for word in [*COMMANDS, "max-gaussians", "check-oracle", "hybrid"]:
                self.assertIn(word, text)
            if shutil.which(shell):
                subprocess.run([shell, "-n"], input=text, text=True, check=True)

    def test_man_page_is_sound(self):
        page = subprocess.run(command("man"), check=True, capture_output=True, text=True).stdout
        for name in COMMANDS:
            self.assertIn(f'.SS "{name}"'.replace("-", "\\-"), page)
        self.assertIn("\\-\\-max\\-gaussians", page)
        if not shutil.which("groff"):
            return
        done = subprocess.run(["groff", "-man", "-Tutf8", "-ww"], input=page, text=True, capture_output=True, check=True)
        self.assertEqual(done.stderr, "")
        self.assertIn("max-gaussians", done.stdout)


class Usage(EndToEnd):
    def test_mistakes_on_the_command_line_end_with_2(self):
        out = self.dir / "usage_out"
        self.error_of(code=2)
        self.error_of("frobnicate", code=2, names=["frobnicate", "reconstruct"])
        self.error_of("reconstuct", self.scene, code=2, names=["'reconstuct'; did you mean 'reconstruct'?"])
        self.error_of("help", "exprot", code=2, names=["did you mean 'export'?"])
        self.error_of("--versoin", code=2, names=["--versoin: no such option; did you mean --version?"])
        self.error_of("reconstruct", code=2, names=["input"])
        self.error_of("reconstruct", self.scene, code=2, names=["-o"])
        self.error_of("reconstruct", self.scene, "-o", out, "--iteration", "100", code=2,
                      names=["--iteration: no such option; did you mean --iterations?"])  # fmt: skip
        self.error_of("reconstruct", self.scene, "-o", out, "-p", code=2, names=["-p: no such option"])
        self.error_of("reconstruct", self.scene, "-o", code=2, names=["--out needs a value"])
        self.error_of("export", self.scene, "--iterations", "5", code=2, names=["--iterations: no such option"])
        self.error_of("reconstruct", self.scene, "-o", out, "--views", "many", code=2, names=["views", "many"])
        self.error_of("reconstruct", self.scene, "-o", out, "--views", "-3", code=2, names=["--views is -3", "0 .. "])
        self.error_of("reconstruct", self.scene, "-o", out, "--set", "ssim-weight=nan", code=2, names=["--set ssim-weight"])
        self.error_of("reconstruct", self.scene, "-o", out, "--iterations", "99999999999", code=2, names=["iterations"])
        self.error_of("reconstruct", self.scene, "-o", out, "--background", "pink", code=2, names=["pink", "white"])
        self.error_of("reconstruct", self.scene, "-o", out, "--background", "whit", code=2, names=["did you mean 'white'?"])
        self.error_of("reconstruct", self.scene, "-o", out, "--preset", "lllff-3", code=2, names=["did you mean 'llff-3'?"])
        self.error_of("reconstruct", self.scene, "-o", out, "--preset", "fast", code=2, names=["fast", "llff-3"])
        self.error_of("evaluate", self.scene, code=2, names=["--ply"])
        self.assertFalse(out.exists())

    def test_mistakes_in_a_configuration_file_end_with_2_and_name_it(self):
        file = self.dir / "bad.toml"
        for text, names in [("iterationz = 5\n", ["iterationz", "did you mean 'iterations'?"]), ('views = "many"\n', ["many"]),
                            ("views = 3\nviews = 4\n", ["views"]), ("[train]\niterations = 5\n", ["train"]),
                            ('background = "white\n', ["background"]), ("views = [1, 2]\n", ["views"]),
                            ("just words\n", ["just words"]),
                            ("{", ["JSON"]), ('{"iterations": [1]}', ["iterations"]), ('{"iterationz": 1}', ["iterationz"]),
                            ('{"options": {"views": "many"}}', ["many"])]:  # fmt: skip
            file.write_text(text)
            with self.subTest(text):
                arguments = ["reconstruct", self.scene, "-o", self.dir / "x", "--config", file]
                self.error_of(*arguments, code=2, names=[file, *names])
        self.error_of("info", self.scene, "--config", self.dir / "none.toml", code=2, names=["none.toml"])

    def test_config_and_flags_mean_the_same_and_flags_win(self):
        file = self.dir / "good.toml"
        file.write_text('# a comment\niterations = 20\nmax-gaussians = 900\nbackground = "white"\nantialiased = true\n'
                        'test-views = "000,001"\ninit = "random"\nrandom-points = 500\n')  # fmt: skip
        names = sorted(p.stem for p in (self.scene / "images").glob("*.png"))[:2]
        flags = ["--iterations", 20, "--max-gaussians", 900, "--background", "white", "--antialiased",
                 "--test-views", ",".join(names), "--init", "random", "--set", "random-points=500"]  # fmt: skip
        file.write_text(file.read_text().replace("000,001", ",".join(names)))
        by_file, by_flags, mixed = (self.dir / name for name in ("by_file", "by_flags", "mixed"))
        self.run_program("train", self.scene, "-o", by_file, "--config", file)
        self.run_program("train", self.scene, "-o", by_flags, *flags)
        self.assertEqual((by_file / "options.json").read_text(), (by_flags / "options.json").read_text())
        self.assertEqual((by_file / "point_cloud.ply").read_bytes(), (by_flags / "point_cloud.ply").read_bytes())

        (self.dir / "presets").mkdir()
        (self.dir / "presets/small.toml").write_text("iterations = 1500\nmax-gaussians = 30000\ndownscale = 2\n")
        env = {**os.environ, "ORACLEGS_PRESETS": str(self.dir / "presets")}
        arguments = ["--config", file, "--preset", "small", "--iterations", 7, "--no-antialiased"]
        self.run_program("sfm", self.scene, "-o", mixed, *arguments, env=env)
        options = json.loads((mixed / "options.json").read_text())["options"]
        self.assertEqual(options["iterations"], 7)  # the command line before the file
        self.assertFalse(options["antialiased"])
        self.assertEqual(options["max-gaussians"], 900)  # the file before the preset
        self.assertEqual(options["downscale"], 2)  # the preset before the default

    def test_config_takes_the_options_of_a_run(self):
        first, second = self.dir / "first", self.dir / "second"
        self.run_program("sfm", self.scene, "-o", first, "--quality", "draft", "--background", "gray", "--init", "random", "--threads", 1)
        self.run_program("sfm", self.scene, "-o", second, "--config", first / "options.json")
        options = [json.loads((out / "options.json").read_text())["options"] for out in (first, second)]
        self.assertEqual(options[0].pop("threads"), 1)
        self.assertEqual(options[1].pop("threads"), 0, "belongs to the machine")
        self.assertEqual(options[0], options[1])
        self.assertEqual(options[0]["background"], "gray")
        plain = self.dir / "plain.json"
        plain.write_text('{"downscale": 4, "init": "random", "antialiased": true}')
        self.run_program("sfm", self.scene, "-o", self.dir / "third", "--config", plain)
        options = json.loads((self.dir / "third/options.json").read_text())["options"]
        self.assertEqual((options["downscale"], options["antialiased"]), (4, True))

    def test_presets_of_the_user_are_found(self):
        folder = self.dir / "my_presets"
        folder.mkdir()
        (folder / "mine.toml").write_text('init = "random"\niterations = 77\n')
        env = {**os.environ, "ORACLEGS_PRESETS": str(folder)}
        self.run_program("sfm", self.scene, "-o", self.dir / "mine", "--preset", "mine", env=env)
        self.assertEqual(json.loads((self.dir / "mine/options.json").read_text())["options"]["iterations"], 77)
        self.error_of("sfm", self.scene, "-o", self.dir / "x", "--preset", "mine", code=2, names=["mine"])

    def test_presets_are_read(self):
        for preset in (ROOT / "presets").glob("*.toml"):
            scene = ["--train-views", ":1,:2,:3", "--test-views", ":0", "--views", 2, "--init", "random", "--set", "random-points=100", "--allow-fallback",
                     "--set", "smaller-copies=auto"]
            self.run_program("sfm", self.scene, "-o", self.dir / preset.stem, "--preset", preset.stem, *scene)


class MainJob(EndToEnd):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.before = files_below(cls.scene)
        cls.out = cls.dir / "out"
        arguments = command("reconstruct", cls.scene, "-o", cls.out, *SMALL_RUN)
        cls.done = subprocess.run(arguments, capture_output=True, text=True, check=True)

    def test_writes_every_file(self):
        options = json.loads((self.out / "options.json").read_text())
        self.assertEqual(options["scene"], str(self.scene.resolve()))
        self.assertEqual(options["options"]["iterations"], 200)
        split = json.loads((self.out / "split.json").read_text())
        self.assertEqual((len(split["train"]), len(split["test"])), (6, 2))
        pictures = sorted(p.name for p in (self.out / "renders/test").glob("*.png"))
        self.assertEqual(len(pictures), 4)
        self.assertEqual(sum(name.endswith("_gt.png") for name in pictures), 2)
        self.assertEqual([p for p in self.out.rglob("*.tmp")], [])

    def test_metrics_have_the_agreed_keys(self):
        metrics = json.loads((self.out / "metrics.json").read_text())
        split = json.loads((self.out / "split.json").read_text())
        self.assertGreater(metrics["test"]["psnr"], 12)
        self.assertTrue(0 < metrics["test"]["ssim"] < 1)
        self.assertEqual([view["name"] for view in metrics["test"]["views"]], split["test"])
        for view in metrics["test"]["views"]:
            self.assertIsInstance(view["psnr"], float)
            self.assertIsInstance(view["ssim"], float)
        for stage in ["train", "evaluate"]:
            self.assertGreaterEqual(metrics["stages"][stage]["seconds"], 0)
        self.assertEqual(metrics["start"], {"source": "random", "points": 1500})
        self.assertEqual(metrics["train"]["iterations"], 200)
        self.assertGreater(metrics["train"]["iterations_per_second"], 0)
        self.assertTrue(0 < metrics["gaussians"] <= 2000)
        self.assertGreater(metrics["peak_memory_bytes"], 1 << 20)
        self.assertRegex(metrics["version"], r"^\d+\.\d+\.\d+$")
        self.assertEqual(metrics["options"]["max-gaussians"], 2000)
        self.assertEqual(metrics["seed"], 0)

    def test_the_ply_is_what_viewers_read(self):
        data = (self.out / "point_cloud.ply").read_bytes()
        header = data[: data.index(b"end_header\n") + 11].decode()
        gaussians = json.loads((self.out / "metrics.json").read_text())["gaussians"]
        self.assertTrue(header.startswith("ply\nformat binary_little_endian 1.0\n"))
        self.assertIn(f"element vertex {gaussians}\n", header)
        names = re.findall(r"property float (\w+)\n", header)
        for name in ["x", "y", "z", "f_dc_0", "f_rest_44", "opacity", "scale_2", "rot_3"]:
            self.assertIn(name, names)
        values = struct.unpack(f"<{gaussians * len(names)}f", data[len(header) :])
        self.assertTrue(all(abs(v) < 1e6 for v in values))

    def test_tells_what_happens_in_plain_lines_and_ends_with_a_summary(self):
        self.assertNotIn("\r", self.done.stderr)
        self.assertIn("6 training views: ", self.done.stderr)
        table = dict(re.findall(r"(?m)^(\w+) +(\d+:\d\d)  ", self.done.stdout))
        for stage, time in re.findall(r"(?m)(\w+): done in (\d+:\d\d)$", self.done.stderr):
            self.assertEqual(table.get(stage, time), time, stage)
        self.assertIn("PSNR", self.done.stdout)
        self.assertIn(str(self.out / "point_cloud.ply"), self.done.stdout)

    def test_the_scene_is_untouched_and_nothing_is_done_twice(self):
        before = files_below(self.out)
        again = self.run_program("reconstruct", self.scene, "-o", self.out, *SMALL_RUN)
        after = files_below(self.out)
        self.assertNotIn("train: started", again.stderr)
        for name in ["point_cloud.ply", "metrics.json"]:
            self.assertEqual(before[name], after[name])
        self.assertEqual(files_below(self.scene), self.before)

    def test_quiet_says_nothing(self):
        done = self.run_program("reconstruct", self.scene, "-o", self.out, "--quiet", *SMALL_RUN)
        self.assertEqual(done.stdout + done.stderr, "")

    def test_other_commands_work_on_the_workspace(self):
        self.assertIn("PSNR", self.run_program("evaluate", self.out).stdout)
        small = self.dir / "small.ply"
        self.run_program("export", self.out, "-o", small, "--sh-degree", 1, "--min-opacity", 0.1)
        self.assertLess(small.stat().st_size, (self.out / "point_cloud.ply").stat().st_size)
        info = json.loads(self.run_program("info", small, "--json").stdout)
        self.assertEqual(info["sh_degree"], 1)
        text = self.run_program("info", self.out).stdout
        self.assertIn("Gaussians", text)
        self.assertRegex(text, r"(?m)^  options +.*iterations 200\b.*; all others at their defaults$")
        self.assertNotIn("synthetic-peak", text)
        self.assertNotRegex(self.run_program("info", small).stdout, r"[1-9]\d*\.\d{5}")
        photos = self.run_program("info", self.scene / "images").stdout
        self.assertRegex(photos, r"(?m)^  sizes +96x72 8$")
        self.assertIn("not known: the photos have no poses", photos)
        self.assertIn("transforms.json", self.run_program("info", self.scene).stdout)

        scores = self.dir / "scores"
        self.run_program("evaluate", self.scene, "--ply", small, "-o", scores, "--test-every", 4)
        self.assertEqual(len(json.loads((scores / "metrics.json").read_text())["test"]["views"]), 2)
        self.assertIn("PSNR", self.run_program("evaluate", self.out, "--ply", small).stdout)
        unscored = self.run_program("evaluate", self.scene, "--ply", small, "--test-every", 0).stdout
        self.assertIn("no test pixels", unscored)

        folder = self.dir / "no_such_folder"
        self.error_of("export", self.out, "-o", f"{folder}/", code=2, names=["is a folder", "scene.spz"])
        self.assertFalse(folder.exists())

        done = self.run_program("render", self.out, "--path", "orbit", "--frames", 3)
        self.assertNotIn("training views", done.stderr, "was said by the run")
        self.assertEqual(done.stderr.count("started"), 1, "of the render alone")
        self.assertEqual(len(list((self.out / "renders/orbit").glob("*.png"))), 3)
        arguments = ["--path", "train", "-o", self.dir / "train", "--no-video"]
        self.run_program("render", self.scene, "--ply", small, *arguments)
        self.assertEqual(len(list((self.dir / "train").glob("*.png"))), 8)

    def test_starts_from_triangulated_points_where_colmap_gives_them(self):
        out = self.dir / "sfm_out"
        arguments = ["--init", "auto", "--iterations", 20, "--max-gaussians", 1000, "--set", "random-points=1000"]
        done = self.run_program("reconstruct", self.scene, "-o", out, *arguments)
        start = json.loads((out / "metrics.json").read_text())["start"]
        if start["source"] == "random":  # no colmap, or too few points: then it must have been said
            self.assertIn("warning", done.stderr)
        else:
            self.assertGreaterEqual(start["points"], 100)

    def test_depth_leaves_pictures_and_a_cloud_that_training_starts_from(self):
        out = self.dir / "depth_out"
        arguments = ["-o", out, "--init", "dense", "--set", "stereo-iterations=2", "--max-gaussians", 1000]
        done = self.run_program("depth", self.scene, *arguments)
        training = json.loads((out / "split.json").read_text())["train"]
        for name in training:
            self.assertRegex(done.stdout, rf"(?m)^{re.escape(name)} +[0-9.]+ % confident$")
            for folder, end in [("", ".png"), ("confidence", ".png"), ("normals", ".png"), ("preview", ".jpg")]:
                picture = (out / "depth" / folder / name.replace("/", "_")).with_suffix(end)
                self.assertTrue(picture.is_file(), picture)
        self.assertEqual(len(json.loads((out / "depth/depth_params.json").read_text())), len(training))
        self.assertTrue((out / "sfm/dense.ply").read_bytes().startswith(b"ply\nformat binary_little_endian 1.0\n"))
        before = files_below(out / "depth")
        self.run_program("train", self.scene, *arguments, "--iterations", 5)
        self.assertEqual(files_below(out / "depth"), before, "found once")
        stages = json.loads((out / "stages.json").read_text())
        self.assertEqual(stages["start"]["source"], "dense")


if __name__ == "__main__":
    main()

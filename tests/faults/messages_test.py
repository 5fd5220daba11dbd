#!/usr/bin/env python3
"""Messages are one line that names the file, and lost output is an error; bad weights and odd names do no harm."""

import json
import shutil
import struct
import subprocess
import unittest

from lab import Lab, error_of

# --force: the colmap that stands in finds matches of no photos, which no poses fit.
QUICK = ["--init", "random", "--set", "random-points=300", "--proposers", "none", "--iterations", 5, "--set", "orbit-frames=0",
         "--no-report", "--force"]  # fmt: skip


class Messages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = Lab(scene=["--demo-views", 5, "--width", 48, "--height", 36, "--samples", 1])
        cls.addClassCleanup(cls.lab.close)
        cls.out = cls.lab.dir / "out"
        cls.lab.finish(cls.out, *QUICK, source=cls.lab.scene)

    def tearDown(self):
        self.lab.check_no_orphans()

    def run_program(self, *arguments, stdout=subprocess.PIPE, cwd=None, timeout=60, **environment):
        done = subprocess.run([self.lab.program, *map(str, arguments)], stdout=stdout, stderr=subprocess.PIPE,
                              stdin=subprocess.DEVNULL, cwd=cwd or self.lab.current, timeout=timeout, check=False,
                              env={**self.lab.environment, **environment})  # fmt: skip
        return done.returncode, done.stderr.decode(errors="replace")

    def error(self, code, *arguments, **options):
        done, text = self.run_program(*arguments, **options)
        self.assertEqual(done, code, text)
        return error_of(text)

    def test_lost_output_is_an_error(self):
        for arguments in [("info", self.lab.scene), ("models", "list"), ("--help",), ("--version",), ("info", self.out)]:
            with self.subTest(arguments[0]), open("/dev/full", "wb") as full:
                self.assertIn("standard output", self.error(4, *arguments, stdout=full))

    def test_names_that_steer_a_terminal(self):
        odd = self.lab.dir / "new\nline\x1b[31m\a\r\t"
        line = self.error(3, "info", odd / "none")
        self.assertIn("new?line?[31m???/none", line)
        shutil.copytree(self.lab.scene, odd)
        (odd / "transforms.json").write_text("{\"frames\": [{\"file_path\": \"a\\n\\u001b[1m\"}]}")
        self.assertIn("transforms.json", self.error(3, "reconstruct", odd, "-o", self.lab.dir / "x", *QUICK))
        (odd / "transforms.json").write_text("{\"\\u001b\\u0007key\": }")
        self.assertIn("transforms.json", self.error(3, "info", odd))
        shutil.rmtree(odd)

    def shown(self, *arguments):
        """What the program prints to stdout, which steers no terminal."""
        done = subprocess.run([self.lab.program, *map(str, arguments)], stdout=subprocess.PIPE, stdin=subprocess.DEVNULL,
                              cwd=self.lab.current, timeout=60, check=True, env=self.lab.environment)  # fmt: skip
        text = done.stdout.decode("latin-1")  # a terminal of 8 bits
        self.assertNotRegex(text, "[\\x00-\\x08\\x0b-\\x1f\\x7f]")
        # In UTF-8, bytes of C1 may continue a character; what is none of it was decoded as a surrogate.
        text = done.stdout.decode("utf-8", errors="surrogateescape")
        self.assertNotRegex(text, "[\\x80-\\x9f\\u2028-\\u202e\\u2066-\\u2069\\udc80-\\udc9f]")
        return text

    def test_texts_of_files_that_steer_a_terminal(self):
        odd = b"\x1b]0;PWNED\x07\x1b[31m \xc2\x9b31m \x9b32m \xe2\x80\xae\xe2\x81\xa6 caf\xc3\xa9"
        splat = self.lab.dir / "odd.ply"
        head, _, rest = (self.out / "point_cloud.ply").read_bytes().partition(b"\n")
        splat.write_bytes(head + b"\ncomment " + odd + b"\n" + rest)
        self.assertIn("]0;PWNED??[31m ?31m ?32m ?? caf\u00e9", self.shown("info", splat))
        self.assertIn("PWNED", json.loads(self.shown("info", splat, "--json"))["comments"][0])
        broken = self.lab.dir / "odd_options"
        shutil.copytree(self.out, broken, symlinks=True)
        options = json.loads((broken / "options.json").read_text())
        text = odd.decode("utf-8", errors="ignore")
        options["scene"] = f"/{text}\nforged  line"
        options["options"]["generator"] = text
        (broken / "options.json").write_text(json.dumps(options))
        self.assertIn("[31m ?31m", self.shown("info", broken))
        self.assertNotIn("\nforged", self.shown("info", broken))
        self.assertEqual(json.loads(self.shown("info", broken, "--json"))["scene"], options["scene"])
        splat.unlink()
        shutil.rmtree(broken)

    def test_an_option_of_a_file_names_the_file(self):
        broken = self.lab.dir / "broken"
        shutil.copytree(self.out, broken, symlinks=True)
        options = json.loads((broken / "options.json").read_text())
        options["options"]["confidence-power"] = 700
        (broken / "options.json").write_text(json.dumps(options))
        line = self.error(3, "evaluate", broken)
        self.assertIn("options.json", line)
        self.assertIn("confidence-power", line)
        options["options"]["confidence-power"] = "\x1b[0m"
        (broken / "options.json").write_text(json.dumps(options))
        self.assertIn("options.json", self.error(3, "evaluate", broken))
        shutil.rmtree(broken)

    def test_a_video_in_a_folder_whose_name_ffmpeg_takes_for_a_protocol(self):
        work = self.lab.dir / "work"
        work.mkdir()
        code, text = self.run_program("render", self.out, "-o", "a:b", "--path", "orbit", "--frames", 3, cwd=work)
        self.assertEqual(code, 0, text)
        self.assertNotIn("warning", text)
        self.assertEqual(len(list(work.rglob("*.mp4"))), 1)
        self.assertEqual([path for path in work.rglob("*") if path.suffix == ".tmp"], [])
        self.lab.fake("ffmpeg", "echo it has no such codec >&2; exit 1")
        code, text = self.run_program("render", self.out, "-o", "c:d", "--path", "orbit", "--frames", 3, cwd=work)
        (self.lab.programs / "ffmpeg").unlink()
        self.assertIn("it has no such codec", text)
        shutil.rmtree(work)

    def test_weights_whose_header_is_a_trap(self):
        def header(text):
            return struct.pack("<Q", len(text)) + text

        deep = b"".join([b'{"a":' * 50_000])
        huge = b'{"a":{"dtype":"F32","data_offsets":[0,4],"shape":[' + b"999999999999999999," * 200_000 + b"1]}}"
        for name, data in [("deep", header(deep)), ("huge", header(huge)), ("lists", header(b"[" * 1_000_000)),
                           ("long", struct.pack("<Q", 1 << 62)), ("zip", b"PK\3\4" + b"\xff" * 200)]:  # fmt: skip
            with self.subTest(name):
                path = self.lab.dir / f"{name}.safetensors"
                path.write_bytes(data)
                line = self.error(3, "models", "convert", path, "-o", self.lab.dir / "weights.safetensors", timeout=30)
                self.assertIn(path.name, line)
                self.assertFalse((self.lab.dir / "weights.safetensors").exists())
                path.unlink()


if __name__ == "__main__":
    unittest.main(verbosity=2)

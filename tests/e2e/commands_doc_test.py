#!/usr/bin/env python3
"""The pages for strangers: docs/commands.md is what the program says of itself, and every link and path in the docs leads somewhere."""

import re
import subprocess
import sys
import unittest
from pathlib import Path

from harness import PROGRAM, ROOT, main

sys.path.insert(0, str(ROOT / "scripts"))
import make_commands_doc  # noqa: E402

PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]


def anchors_of(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
    headings = re.findall(r"^#+ (.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings}


class CommandsPage(unittest.TestCase):
    def test_equals_the_help_of_the_program(self):
        check = [sys.executable, ROOT / "scripts/make_commands_doc.py", "--check", PROGRAM]
        done = subprocess.run(check, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_has_every_option_of_every_command(self):
        page = make_commands_doc.PAGE.read_text()
        for name in re.findall(r"^## ([a-z-]+)$", page, re.M):
            for option in re.findall(r"(?m)^  (?:-\w,)?(--[a-z-]+)", make_commands_doc.help_of(PROGRAM, name)):
                self.assertIn(option, page, name)


class Links(unittest.TestCase):
    def test_lead_to_a_file_and_a_heading(self):
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
                if re.match(r"[a-z]+:", target):
                    continue
                path, _, anchor = target.partition("#")
                file = (page.parent / path).resolve() if path else page
                with self.subTest(f"{page.name}: {target}"):
                    self.assertTrue(file.exists())
                    if anchor:
                        self.assertIn(anchor, anchors_of(file))

    def test_paths_of_sources_exist(self):
        for page in PAGES:
            for path in re.findall(r"`((?:src|apps|tests|bench|scripts|presets|docs|cmake)/[a-z\d_./-]+)`", page.read_text()):
                with self.subTest(f"{page.name}: {path}"):
                    self.assertTrue((ROOT / path).exists() or list(ROOT.glob(path + ".*")))


if __name__ == "__main__":
    main()

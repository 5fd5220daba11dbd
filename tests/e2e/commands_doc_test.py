#!/usr/bin/env python3
"""The pages for strangers: docs/commands.md is what the program says of itself, and the docs name what is there."""

import json
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
            for option in re.findall(r"(?m)^  (?:-\w, )?(--[a-z-]+)", make_commands_doc.help_of(PROGRAM, name)):
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


class ArchitecturePage(unittest.TestCase):
    PAGE = ROOT / "docs/architecture.md"

    def test_key_classes_are_in_their_files(self):
        rows = re.findall(r"^\| (`\w.*?) \| `([\w/.-]+\.h)`", self.PAGE.read_text(), re.M)
        self.assertGreaterEqual(len(rows), 25)
        for names, path in rows:
            file = ROOT / "src/oraclegs" / path
            with self.subTest(path):
                self.assertTrue(file.is_file())
                name = re.search(r"\w+", names).group()
                self.assertRegex(file.read_text(), rf"\b{name}\b")

    def test_floors_are_those_of_the_build(self):
        floors = json.loads((Path(PROGRAM).parent.parent / "floors.json").read_text())
        built = {floor["name"]: set(floor["uses"]) for floor in floors}
        table = self.PAGE.read_text().partition("| floor |")[2].partition("\n\n")[0]
        rows = re.findall(r"^\| `(\w+)` \|.*\|([^|]*)\|$", table, re.M)
        self.assertEqual({name: set(re.findall(r"\w+", uses)) for name, uses in rows}, built)

    def test_stages_are_those_of_the_program(self):
        listed = re.findall(r'^ +\{"(\w+)", \w+, ', (ROOT / "src/oraclegs/run/stages.cpp").read_text(), re.M)
        table = self.PAGE.read_text().partition("| stage |")[2].partition("\n\n")[0]
        self.assertEqual(re.findall(r"^\| `(\w+)`", table, re.M), listed)


if __name__ == "__main__":
    main()

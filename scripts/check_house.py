#!/usr/bin/env python3
"""Refuses what breaks the rules of the house (CONTRIBUTING.md). One line per violation, `file:line: what`; exit code 1.

usage: scripts/check_house.py [ROOT]
"""

import re
import sys
from pathlib import Path

# The floors, bottom first; those of one line do not know each other.
FLOORS = [["core"], ["scene", "models"], ["demo", "depth", "nets", "gaussians"], ["render"], ["loss", "propose"], ["train", "evaluate", "validate"], ["pipeline"]]
RANK = {floor: rank for rank, floors in enumerate(FLOORS) for floor in floors}
TORCH_FREE_FLOORS = {"core", "scene", "models", "demo", "depth"}
TORCH_HEADER_OF_CORE = "core/tensor.h"

FOLDERS = ["src", "apps", "tests", "bench", "scripts", "cmake"]
CPP = {".cpp", ".h", ".cu", ".cuh"}
SOURCES = CPP | {".py", ".sh", ".cmake"}
MAX_LINES = 500
MAX_DEPTH = 4  # folders below src

# src file below src/oraclegs -> why no tests/FLOOR/..._test.cpp has its name. Keep it tiny.
WITHOUT_TEST = {}

INCLUDE = re.compile(r'^\s*#\s*(?:include|define\s+HWY_TARGET_INCLUDE)\s*[<"]([^>"]+)[>"]')
TORCH = re.compile(r"^(torch|ATen|c10|caffe2)/")
OWN = re.compile(r"^oraclegs/(([^/]+)/.+)$")
LATER = re.compile(r"\b(TO" + r"DO|FIX" + r"ME)\b")
PRINTS = re.compile(
    r"\bstd::(cout|cerr|clog)\b|\bfmt::print\b|(?<![\w.>])(?:std::)?(v?f?printf|puts|_?exit|quick_exit|abort)\s*\("
)
SKIPPED = re.compile(r"GTEST_SKIP\s*\(\s*\)(?!\s*<<)")
DISABLED = re.compile(r"\bDISABLED_\w")
TEXT_OR_COMMENT = re.compile(r'"(?:\\.|[^"\\])*"|//.*|/\*.*?\*/')


def code_of(line):
    """The line without texts and comments (block comments over several lines are not used in this house)."""
    return TEXT_OR_COMMENT.sub('""', line)


class House:
    def __init__(self, root):
        self.root = root
        self.violations = []
        self.lines = {}
        for folder in FOLDERS:
            for path in sorted((root / folder).rglob("*")):
                if path.is_file() and path.suffix in SOURCES and "__pycache__" not in path.parts:
                    text = path.read_text(encoding="utf-8", errors="replace")
                    self.lines[path.relative_to(root).as_posix()] = text.splitlines()
        self.own_includes = {name: self._own_includes(name) for name in self.lines if name.startswith("src/oraclegs/")}

    def refuse(self, name, line, what):
        self.violations.append((name, line, what))

    def includes(self, name):
        for number, line in enumerate(self.lines[name], 1):
            match = INCLUDE.match(line)
            if match:
                yield number, match.group(1)

    def _own_includes(self, name):
        return [header for _, header in self.includes(name) if OWN.match(header)]

    def reaches_torch(self, name, seen):
        """True when this file of src includes a torch header, also through others of the house."""
        if name in seen or name not in self.own_includes:
            return False
        seen.add(name)
        if any(TORCH.match(header) for _, header in self.includes(name)):
            return True
        return any(self.reaches_torch("src/" + header, seen) for header in self.own_includes[name])

    def check(self):
        for name, lines in self.lines.items():
            suffix = Path(name).suffix
            if len(lines) > MAX_LINES:
                self.refuse(name, MAX_LINES + 1, f"has {len(lines)} lines, at most {MAX_LINES}: it is two ideas")
            self.check_lines(name, lines, suffix)
            if suffix in CPP and name.startswith("src/"):
                self.check_depth(name)
                self.check_includes(name, suffix)
                self.check_mirror(name, suffix)
        for name in WITHOUT_TEST:
            if "src/oraclegs/" + name not in self.lines:
                self.refuse("scripts/check_house.py", 1, f"{name} is excused from a test but does not exist")
        return sorted(self.violations)

    def check_lines(self, name, lines, suffix):
        for number, line in enumerate(lines, 1):
            match = LATER.search(line)
            if match:
                self.refuse(name, number, f"{match.group(1)}: do it now, or open an issue")
            if suffix not in CPP:
                continue
            code = code_of(line)
            match = PRINTS.search(code) if name.startswith("src/") else None
            if match:
                self.refuse(name, number, f"{match.group(0).strip(' (')}: the library neither prints nor exits")
            if SKIPPED.search(code):
                self.refuse(name, number, "GTEST_SKIP without a reason: GTEST_SKIP() << \"needs ...\"")
            above = lines[number - 2] if number > 1 else ""
            if DISABLED.search(code) and "//" not in line and not above.lstrip().startswith("//"):
                self.refuse(name, number, "a DISABLED_ test without a comment that says why")

    def check_depth(self, name):
        depth = len(Path(name).parts) - 2
        if depth > MAX_DEPTH:
            self.refuse(name, 1, f"lies {depth} folders below src, at most {MAX_DEPTH}")

    def check_includes(self, name, suffix):
        own = OWN.match(name[len("src/"):])
        floor = own.group(2) if own else None
        if floor not in RANK:
            self.refuse(name, 1, "is on no floor: give its folder a place in FLOORS of scripts/check_house.py")
            return
        torch_free = suffix in {".cu", ".cuh"} or floor in TORCH_FREE_FLOORS
        if own.group(1) == TORCH_HEADER_OF_CORE:
            torch_free = False
        for number, header in self.includes(name):
            target = OWN.match(header)
            if target:
                self.check_floor(name, number, floor, target.group(2))
            if not torch_free:
                continue
            if TORCH.match(header) or (target and self.reaches_torch("src/" + header, set())):
                where = f"a {suffix} file" if suffix in {".cu", ".cuh"} else f"floor {floor}"
                self.refuse(name, number, f"<{header}> brings libtorch into {where}, which is free of it")

    def check_floor(self, name, number, floor, target):
        if target not in RANK:
            self.refuse(name, number, f"includes from {target}, which is no floor")
        elif target != floor and RANK[target] >= RANK[floor]:
            self.refuse(name, number, f"floor {floor} includes from {target}, which is not below it")

    def check_mirror(self, name, suffix):
        if suffix != ".cpp":
            return
        own = Path(name).relative_to("src/oraclegs")
        if own.as_posix() in WITHOUT_TEST:
            return
        pattern = re.compile(rf"^tests/{own.parts[0]}/(.*/)?{re.escape(own.stem)}(_\w+)?_test\.cpp$")
        if not any(pattern.match(other) for other in self.lines):
            self.refuse(name, 1, f"has no test: write tests/{own.parts[0]}/{own.stem}_test.cpp")


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    violations = House(root).check()
    for name, line, what in violations:
        print(f"{name}:{line}: {what}")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())

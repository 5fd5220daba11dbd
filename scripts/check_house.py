#!/usr/bin/env python3
"""Refuses what breaks the rules of the house (CONTRIBUTING.md). One line per violation, `file:line: what`; exit code 1.

usage: scripts/check_house.py [ROOT] [FLOORS.json]

FLOORS.json is what CMake writes into a build folder; the newest of build/*/floors.json is taken when it is not given.
"""

import json
import re
import sys
from collections import defaultdict
from pathlib import Path

TORCH_ROOMS = re.compile(r"^networks/[^/]+/")  # the only folders below src/oraclegs that may include libtorch
DEVICE_ROOMS = {"cpu", "cuda"}  # back ends, which the files beside their folder choose between

FOLDERS = ["src", "apps", "tests", "bench", "scripts", "cmake"]
CPP = {".cpp", ".h", ".cu", ".cuh"}
SOURCES = CPP | {".py", ".sh", ".cmake"}
MAX_LINES = 500  # of a file
MAX_UNIT_LINES = 400  # of a unit's header and source together, below src
MAX_DEPTH = 4  # folders below src
MAX_PARAMETERS = 5
MAX_UNITS_IN_ROOM = 25  # of a folder above the engine
ROOMS = ("settings", "workspace", "stages", "proposers", "output", "run")

# src file below src/oraclegs -> why no tests/FLOOR/..._test.cpp has its name. Keep it empty.
WITHOUT_TEST = {}

# Floors below settings and above take values. The others of these have options of another command, which its own entry
# settles, or one on which the scene has a say.
SETTLES = re.compile(
    r"^src/oraclegs/(settings/|core/options\.h$|scene/split\.cpp$|output/export\.cpp$|experiments/launch/make_launcher\.cpp$)"
)
INCLUDE = re.compile(r'^\s*#\s*(?:include|define\s+HWY_TARGET_INCLUDE)\s*[<"]([^>"]+)[>"]')
TORCH = re.compile(r"^(torch|ATen|c10|caffe2)/")
OWN = re.compile(r"^oraclegs/(([^/]+)/.+)$")
GENERATED = {"oraclegs/core/config.h"}
LATER = re.compile(r"\b(TO" + r"DO|FIX" + r"ME)\b")
PRINTS = re.compile(
    r"\bstd::(cout|cerr|clog)\b|\bfmt::print\b|(?<![\w.>])(?:std::)?(v?f?printf|puts|_?exit|quick_exit|abort)\s*\("
)
PRINTS_UNSEEN = re.compile(PRINTS.pattern.replace("v?f?printf|puts", "v?f?printf|f?puts|putc(?:har)?|fputc|fwrite"))
TERMINAL = "apps/oraclegs/terminal.cpp"  # the only file of the program that prints
FORKS = {"src/oraclegs/core/process_group.cpp"}  # its children end themselves
CASTS = re.compile(r"\b(const_cast|dynamic_cast)\b")
SKIPPED = re.compile(r"GTEST_SKIP\s*\(\s*\)(?!\s*<<)")
DISABLED = re.compile(r"\bDISABLED_\w")
TEXT_OR_COMMENT = re.compile(r'"(?:\\.|[^"\\])*"|//.*|/\*.*?\*/')
COMMENT = re.compile(r"//.*|^\s*#.*")
SIGNATURE = re.compile(r"(?<![\w.>])(?!(?:return|else|new|throw|case|using|co_return)\b)[\w:<>,*&\]]+[\s*&]+(?:\w+::)*(~?\w+)\(")
TYPE = re.compile(r"^(?:struct|class|enum class|union) (?:alignas\(\w+\) )?(\w+)(?: final)?(?: : [^;]*)? ?\{")
NAMESPACE = re.compile(r"^(?:inline )?namespace ?([\w:]*) ?\{")

WORKSHOP = re.compile(r"\.\./shared|\bshared/(?:data|spec|golden|review)\b|\bCI minutes\b")
SPEC = re.compile(r"\bspec/|\bspec \d|\((?:spec )?[1-9]\.\d\)|\[(?:3DGS|MCMC|gsplat)\]")
METHOD = re.compile(r"docs/method\.md(?:#([\w-]+))?")
REFERENCE = re.compile(r"\[([A-Z][\w\-']+(?: et al\.)? (?:19|20)\d\d[a-z]?)\]")
HISTORY = re.compile(r"\bissue #?\d+\b|(?<![\w/.#&])#\d{1,3}\b|\bcommit [0-9a-f]{7,40}\b|\b(?=[0-9a-f]*\d)(?=[0-9a-f]*[a-f])[0-9a-f]{7}\b")

# A doc comment begins with its subject; so does each of its sentences.
HEADLESS = re.compile(r"(?:^\s*/// |///< |/// [^`]*?[.!?] )((?:Of|What|The same|Both|Likewise|That which)\b)")
# Code, comments, messages and pages are in American spelling.
BRITISH = re.compile(
    r"colour|grey(?!hound)|neighbour|licence|centre|centring|learnt|misspelt|behaviour|favour|honour|labelled(?!by)|modelled|artefact|catalogue|"
    r"judgement|fibre|\b(?:centi|milli|kilo)?metre|(?:analy|regulari|rasteri|initiali|optimi|normali|minimi|maximi|summari|visuali|recogni|organi|"
    r"standardi|seriali|synchroni|speciali|quanti|vectori|lineari|parametri|generali|utili|reali)s(?:e[ds]?|ing|ations?|ers?|able)(?-i:(?![a-z]))",
    re.I)  # fmt: skip
# Texts that stay: words in the names of files that people bring.
OTHERS_WORDS = {"colour"}
TEXT = re.compile(r'"((?:\\.|[^"\\])*)"')


def code_of(line):
    """The line without texts and comments (block comments over several lines are not used in this house)."""
    return TEXT_OR_COMMENT.sub('""', line)


def unit_of(name):
    """A header and its source are one unit; so is a .cu file and its header."""
    return re.sub(r"\.(h|cpp|cu|cuh)$", "", name)


def circles(graph):
    """The strongly connected components of more than one node, each sorted."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(graph.get(node, ())):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            component = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(component) > 1:
                found.append(sorted(component))

    sys.setrecursionlimit(10000)
    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def heading_anchor(line):
    """GitHub's anchor of a Markdown heading."""
    text = re.sub(r"[^\w\- ]", "", line.lstrip("#").strip().lower())
    return text.replace(" ", "-")


class House:
    def __init__(self, root, floors):
        """floors: [{"name": "core", "uses": []}, ...], bottom first."""
        self.root = root
        self.violations = []
        self.below = {}
        for floor in floors:
            uses = set(floor["uses"])
            self.below[floor["name"]] = uses.union(*(self.below.get(use, set()) for use in uses))
        self.lines, self.docs = {}, {}
        for folder in FOLDERS:
            for path in sorted((root / folder).rglob("*")):
                if path.is_file() and path.suffix in SOURCES and "__pycache__" not in path.parts:
                    self.lines[path.relative_to(root).as_posix()] = self._read(path)
        for path in sorted([*root.glob("*.md"), *(root / "docs").rglob("*.md"), *(root / "presets").glob("*.toml")]):
            self.docs[path.relative_to(root).as_posix()] = self._read(path)
        self.own_includes = {name: self._own_includes(name) for name in self.lines if name.startswith("src/oraclegs/")}
        self.types = defaultdict(dict)

    @staticmethod
    def _read(path):
        return path.read_text(encoding="utf-8", errors="replace").splitlines()

    def refuse(self, name, line, what):
        self.violations.append((name, line, what))

    def includes(self, name):
        for number, line in enumerate(self.lines[name], 1):
            match = INCLUDE.match(line)
            if match:
                yield number, match.group(1)

    def _own_includes(self, name):
        return [header for _, header in self.includes(name) if OWN.match(header) and header not in GENERATED]

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
            self.check_spelling(name, lines)
            if suffix in CPP:
                self.check_doc_comments(name, lines)
            self.check_citations(name, lines)
            if suffix in CPP and name.startswith("src/"):
                self.check_depth(name)
                self.check_includes(name)
                self.check_mirror(name, suffix)
                self.check_parameters(name, lines)
                self.check_types(name, lines)
        self.check_units()
        self.check_circles()
        for name, lines in self.docs.items():
            self.check_citations(name, lines)
            self.check_history(name, lines)
            self.check_spelling(name, lines)
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
            if match and name not in FORKS:
                self.refuse(name, number, f"{match.group(0).strip(' (')}: the library neither prints nor exits")
            match = PRINTS_UNSEEN.search(code) if name.startswith("apps/") and name != TERMINAL else None
            if match:
                self.refuse(name, number, f"{match.group(0).strip(' (')}: the program prints through {TERMINAL} alone")
            if SKIPPED.search(code):
                self.refuse(name, number, "GTEST_SKIP without a reason: GTEST_SKIP() << \"needs ...\"")
            above = lines[number - 2] if number > 1 else ""
            if ".ValueOr(" in code and name.startswith("src/") and not SETTLES.match(name):
                self.refuse(name, number, "settles an automatic option: settings/ does, others take its value")
            match = CASTS.search(code) if name.startswith("src/") else None
            if match and "//" not in line and not above.lstrip().startswith("//"):
                self.refuse(name, number, f"{match.group(1)} without a comment that says why; better change the interface")
            if DISABLED.search(code) and "//" not in line and not above.lstrip().startswith("//"):
                self.refuse(name, number, "a DISABLED_ test without a comment that says why")

    def check_citations(self, name, lines):
        """What a comment or a page cites is in the repository."""
        if name.startswith("scripts/check_house"):
            return
        anchors = {heading_anchor(line) for line in self.docs.get("docs/method.md", []) if line.startswith("#")}
        keys = set(REFERENCE.findall("\n".join(self.docs.get("docs/references.md", []))))
        for number, line in enumerate(lines, 1):
            text = line if name.endswith((".md", ".toml")) else "".join(COMMENT.findall(line))
            match = WORKSHOP.search(line)
            if match:
                self.refuse(name, number, f"{match.group(0)}: is not in the repository")
            match = SPEC.search(text)
            if match:
                self.refuse(name, number, f"cites {match.group(0)}: cite docs/method.md#SECTION or a key of docs/references.md")
            for anchor in METHOD.findall(line):
                if anchor and anchor not in anchors:
                    self.refuse(name, number, f"docs/method.md has no section #{anchor}")
            for key in REFERENCE.findall(text):
                if key not in keys:
                    self.refuse(name, number, f"docs/references.md has no [{key}]")

    def check_spelling(self, name, lines):
        if name.startswith("scripts/check_house"):
            return
        for number, line in enumerate(lines, 1):
            for match in BRITISH.finditer(line):
                if line[match.start() - 1:match.end() + 1].strip('"') not in OTHERS_WORDS:
                    self.refuse(name, number, f"{match.group(0)}: use American spelling")

    def check_doc_comments(self, name, lines):
        for number, line in enumerate(lines, 1):
            match = HEADLESS.search(line)
            if match:
                self.refuse(name, number, f'"{match.group(1)} ...": begin the sentence with its subject')

    def check_history(self, name, lines):
        for number, line in enumerate(lines, 1):
            match = HISTORY.search(line)
            if match:
                self.refuse(name, number, f"{match.group(0).strip()}: pages show the state of today; history is in git")

    def check_depth(self, name):
        depth = len(Path(name).parts) - 2
        if depth > MAX_DEPTH:
            self.refuse(name, 1, f"lies {depth} folders below src, at most {MAX_DEPTH}")

    def check_includes(self, name):
        own = OWN.match(name[len("src/"):])
        floor = own.group(2) if own else None
        if floor not in self.below:
            self.refuse(name, 1, "is on no floor: give its folder a line in src/CMakeLists.txt")
            return
        torch_free = not TORCH_ROOMS.match(own.group(1))
        for number, header in self.includes(name):
            target = OWN.match(header)
            if target:
                self.check_floor(name, number, floor, target.group(2))
            if torch_free and (TORCH.match(header) or (target and self.reaches_torch("src/" + header, set()))):
                self.refuse(name, number, f"<{header}> brings libtorch into {Path(own.group(1)).parent}, which is free of it")

    def check_floor(self, name, number, floor, target):
        if target not in self.below:
            self.refuse(name, number, f"includes from {target}, which is no floor")
        elif target != floor and target not in self.below[floor]:
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

    def check_parameters(self, name, lines):
        """Counts the parameters of what looks like a function's declaration: every one has a type and a name."""
        text = "\n".join(code_of(line) for line in lines)
        for match in SIGNATURE.finditer(text):
            depth, end, parameters, start = 1, match.end(), [], match.end()
            while end < len(text) and depth:
                depth += {"(": 1, "<": 1, "{": 1, "[": 1, ")": -1, ">": -1, "}": -1, "]": -1}.get(text[end], 0)
                if text[end] == "," and depth == 1:
                    parameters.append(text[start:end])
                    start = end + 1
                end += 1
            parameters.append(text[start:end - 1])
            named = all(re.match(r"^\s*[\w:<>,\s*&()\[\].]+[\s*&>]\s*\w*(\[\w*\])?\s*(=.*)?$", p, re.S) for p in parameters)
            if len(parameters) > MAX_PARAMETERS and named:
                number = text.count("\n", 0, match.start(1)) + 1
                self.refuse(name, number, f"{match.group(1)} has {len(parameters)} parameters, at most {MAX_PARAMETERS}: name a struct")

    def check_types(self, name, lines):
        """A type's name stands once in a namespace; anonymous namespaces are their file's own."""
        spaces = []
        for number, line in enumerate(lines, 1):
            match = NAMESPACE.match(line)
            if match:
                spaces.append(match.group(1) or f"(anonymous in {name})")
                continue
            if re.match(r"^\}\s*// namespace", line):
                if spaces:
                    spaces.pop()
                continue
            match = TYPE.match(line)
            if not match or not spaces:
                continue
            key = ("::".join(spaces), match.group(1))
            other = self.types[key].setdefault("place", (name, number))
            if other != (name, number) and unit_of(other[0]) != unit_of(name):
                self.refuse(name, number, f"{match.group(1)} is also a type in {other[0]}: two types of one name in {key[0]}")

    def check_units(self):
        """Length of a unit, number of units in a room."""
        length, rooms = defaultdict(int), defaultdict(set)
        for name, lines in self.lines.items():
            if name.startswith("src/oraclegs/") and Path(name).suffix in CPP:
                unit = unit_of(name)
                length[unit] += len(lines)
                rooms[str(Path(unit).parent)].add(unit)
        for unit, lines in length.items():
            if lines > MAX_UNIT_LINES:
                suffix = ".cpp" if unit + ".cpp" in self.lines else ".h"
                self.refuse(unit + suffix, 1, f"the unit has {lines} lines, at most {MAX_UNIT_LINES}: it is two ideas")
        for room, units in rooms.items():
            if room.startswith(tuple("src/oraclegs/" + floor for floor in ROOMS)) and len(units) > MAX_UNITS_IN_ROOM:
                self.refuse(room, 1, f"has {len(units)} units, at most {MAX_UNITS_IN_ROOM}")

    def check_circles(self):
        """No circle between units, nor between the rooms of a floor."""
        units, rooms = defaultdict(set), defaultdict(set)
        for name, headers in self.own_includes.items():
            unit = unit_of(name)
            units[unit].update(unit_of("src/" + header) for header in headers)
            units[unit].discard(unit)
        for unit, others in units.items():
            for other in others:
                here, there = Path(unit).parent, Path(other).parent
                if here != there and here.parts[2] == there.parts[2] and not {here.name, there.name} & DEVICE_ROOMS:
                    rooms[here.as_posix()].add(there.as_posix())
        for circle in circles(units):
            first = next(n for n in self.own_includes if unit_of(n) == circle[0])
            self.refuse(first, 1, f"includes itself through {', '.join(circle[1:])}")
        for circle in circles(rooms):
            self.refuse(circle[0], 1, f"the room includes itself through {', '.join(circle[1:])}")


def find_floors(root):
    found = sorted(root.glob("build/*/floors.json"), key=lambda path: path.stat().st_mtime)
    if not found:
        sys.exit("scripts/check_house.py: there is no build/*/floors.json; run cmake --preset release first")
    return found[-1]


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    floors = Path(sys.argv[2]) if len(sys.argv) > 2 else find_floors(root)
    violations = House(root, json.loads(floors.read_text())).check()
    for name, line, what in violations:
        print(f"{name}:{line}: {what}")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Line coverage of the parsers, from `llvm-cov export -format=lcov`: a row for each file, the lines that are left, the sum.

usage: tests/fuzz/coverage.py LINES PARSERS
"""

import re
import sys
from pathlib import Path


def read(path):
    """File -> {line: count}, and {line: name of the function that begins there}."""
    files, lines, functions = {}, None, None
    for row in Path(path).read_text().splitlines():
        if row.startswith("SF:"):
            lines, functions = files.setdefault(row[3:], ({}, {}))
        elif row.startswith("FN:"):
            number, name = row[3:].split(",", 1)
            functions[int(number)] = functions.get(int(number), "") + " " + name
        elif row.startswith("DA:"):
            number, count = row[3:].split(",")[:2]
            lines[int(number)] = max(int(count), lines.get(int(number), 0))
    return files


def of_functions(lines, functions, words):
    """The lines of the functions whose mangled names have one of the words as a name; all without words."""
    if not words:
        return lines
    names = re.compile("|".join(rf"\d{word}" for word in words))
    kept = {}
    for number in sorted(lines):
        begun = [line for line in functions if line <= number]
        if begun and names.search(functions[max(begun)]):
            kept[number] = lines[number]
    return kept


def ranges(numbers):
    """[1, 2, 3, 7] -> "1-3 7"."""
    groups = []
    for number in numbers:
        if groups and number == groups[-1][1] + 1:
            groups[-1][1] = number
        else:
            groups.append([number, number])
    return " ".join(f"{a}" if a == b else f"{a}-{b}" for a, b in groups)


def main():
    files = read(sys.argv[1])
    parsers = [line for line in Path(sys.argv[2]).read_text().splitlines() if line and not line.startswith("#")]
    all_lines = all_hit = 0
    for row in parsers:
        parser, *words = row.split()
        found = next((both for file, both in files.items() if file.endswith("/" + parser)), ({}, {}))
        lines = of_functions(*found, words)
        if not lines:
            sys.exit(f"{parser}: is in no target")
        hit = sum(count > 0 for count in lines.values())
        left = sorted(number for number, count in lines.items() if count == 0)
        print(f"{100 * hit / len(lines):5.1f} %  {hit:4}/{len(lines):<4}  {parser}  {ranges(left)}")
        all_lines += len(lines)
        all_hit += hit
    print(f"{100 * all_hit / all_lines:5.1f} %  {all_hit}/{all_lines} lines of {len(parsers)} files")


if __name__ == "__main__":
    main()

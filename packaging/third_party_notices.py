#!/usr/bin/env python3
"""Writes THIRD_PARTY_NOTICES.md from what is linked and compiled in: the shared libraries that the given programs and
libraries name, the packages whose headers the sources include, and the npm packages that web/build.mjs bundles.

  packaging/third_party_notices.py --source . -o NOTICES.md build/release/bin/oraclegs build/release/lib/liboraclegs_core.so

Names, versions and licenses come from dpkg and /usr/share/doc. On other systems, the table has the names alone."""

import argparse
import json
import re
import shutil
import subprocess
from pathlib import Path

# Headers that other headers include: OpenVDB's and Highway's are templates of these.
INDIRECT_HEADERS = {"boost/version.hpp", "Imath/half.h"}
NOT_LISTED = ("liboraclegs_", "ld-linux-aarch64.so")  # ours; the loader, which is glibc's
# Longer texts are named, not repeated: Boost's has 45 000 lines.
MAX_TEXT_LINES = 1000

HEAD = """# Third-party notices

OracleGS is licensed under Apache-2.0 (LICENSE). It is linked to, or contains parts of, the software below. This file was made from
the built program by `packaging/third_party_notices.py`.

*linked*: a shared library of the system, not part of this distribution. *compiled in*: headers whose code is part of the program.
*bundled*: JavaScript of the viewer and the report, part of the program. Debian has the full text of each license in the file named.
"""


def output_of(*command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else ""


def needed(binary):
    """Names of the shared libraries that a program or library names itself: {'libz.so.1', ...}."""
    text = subprocess.run(["readelf", "-d", binary], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"\(NEEDED\).*\[(.*)\]", text))


def paths_of_libraries():
    """{name: path} of the dynamic loader's cache."""
    return dict(reversed(re.findall(r"^\s+(\S+) .*=> (\S+)$", output_of("/sbin/ldconfig", "-p"), re.M)))


def included_headers(source):
    """System headers that the sources include by a path with a folder or a suffix: not the standard library's."""
    headers = set(INDIRECT_HEADERS)
    for folder in ("src", "apps"):
        for file in (source / folder).rglob("*"):
            if file.suffix in (".h", ".cpp") and "cuda" not in file.parts:
                headers.update(re.findall(r"^#include <([^>]*[/.][^>]*)>", file.read_text(), re.M))
    return headers


def header_file(header):
    for folder in ("/usr/include", "/usr/include/eigen3", "/usr/include/x86_64-linux-gnu", "/usr/include/cairo"):
        path = Path(folder) / header
        if path.exists():
            return path.resolve()
    return None


def spellings(path):
    """Names that dpkg may know a file by: it may have been installed below /lib, which is a link to /usr/lib."""
    real = str(path.resolve())
    return {str(path), real, "/usr" + str(path), *(name.removeprefix("/usr") for name in (str(path), real))}


def owners(paths):
    """{path: the Debian package that it belongs to}, of those that belong to one."""
    if not paths or not shutil.which("dpkg-query"):
        return {}
    names = {name: path for path in paths for name in spellings(path)}
    found = subprocess.run(["dpkg-query", "-S", *sorted(names)], capture_output=True, text=True, check=False).stdout
    lines = re.findall(r"^([^,:\s]+)[^\n]*: (/.*)$", found, re.M)
    return {names[name]: package for package, name in lines if name in names}


def copyright_file(package):
    return Path("/usr/share/doc") / package / "copyright"


def licenses(text):
    """Licenses of a Debian copyright file: of its main part, else all that it names."""
    main = re.search(r"^Files: *\*.*?^License: *(.+?)$", text, re.M | re.S)
    if main:
        return main.group(1).strip()
    return ", ".join(sorted(set(re.findall(r"^License: *(\S.*?)\s*$", text, re.M))))


class Component:
    """A source package: how it takes part, and what is known about it."""

    def __init__(self, package):
        fields = output_of("dpkg-query", "-W", "-f=${source:Package}\t${source:Version}\t${Homepage}", package).split("\t")
        self.name, self.version, self.homepage = (fields + ["", "", ""])[:3]
        self.package = package
        self.uses = set()  # "linked", "compiled in"
        self.libraries = set()

    def text(self):
        file = copyright_file(self.package)
        return file.read_text(errors="replace") if file.exists() else ""


def components_of(binaries, source):
    """Source packages by name, and the libraries that no package owns."""
    known = paths_of_libraries()
    libraries = {n: Path(known.get(n, n)) for n in set().union(*map(needed, binaries)) if not n.startswith(NOT_LISTED)}
    headers = {}  # one of each folder is enough
    for header in sorted(included_headers(source)):
        if header_file(header):
            headers.setdefault(header.split("/")[0], header_file(header))
    package_of = owners({*libraries.values(), *headers.values()})

    libraries_of = {}
    for name, path in libraries.items():
        libraries_of.setdefault(package_of.get(path), set()).add(name)

    found = {}  # the packages of the libraries first: their copyright file is on a user's machine
    packages = set(package_of.values()) - {"libc6-dev", "linux-libc-dev"}
    for package in sorted(packages, key=lambda package: (package not in libraries_of, package)):
        component = Component(package)
        component = found.setdefault(component.name, component)
        names = libraries_of.get(package, set())
        component.libraries |= names
        component.uses.add("linked" if names else "compiled in")
    return found, libraries_of.get(None, set())


def npm_packages(source):
    """[(name, version, license, text)] of what is bundled: dependencies of web/, and theirs."""
    lock = json.loads((source / "web/package-lock.json").read_text())["packages"]
    rows = []
    for path, entry in sorted(lock.items()):
        if path and not entry.get("dev") and not entry.get("optional"):
            file = source / "web" / path / "LICENSE"
            text = file.read_text() if file.exists() else ""
            rows.append((path.removeprefix("node_modules/"), entry["version"], entry.get("license", "see its text"), text))
    return rows


def notices(binaries, source):
    found, unowned = components_of(binaries, source)
    rows, texts = [], []
    for name, component in sorted(found.items()):
        text = component.text()
        how = " and ".join(sorted(component.uses, reverse=True))
        libraries = ", ".join(sorted(component.libraries)) or "headers"
        rows.append(f"| [{name}]({component.homepage}) | {component.version} | {licenses(text) or 'see the file'} | {how} | "
                    f"{libraries} | `{copyright_file(component.package)}` |")  # fmt: skip
        if "compiled in" in component.uses and 0 < text.count("\n") < MAX_TEXT_LINES:
            texts.append((name, text))
    rows += [f"| {name} | | not known | linked | {name} | |" for name in sorted(unowned)]
    for name, version, license_name, text in npm_packages(source):
        rows.append(f"| [{name}](https://www.npmjs.com/package/{name}) | {version} | {license_name} | bundled | JavaScript | |")
        texts.append((name, text))
    table = "| component | version | license | how | as | license text |\n| --- | --- | --- | --- | --- | --- |\n"
    parts = [HEAD, table + "\n".join(rows)]
    parts += [f"## {name}\n\n```\n{text.strip()}\n```" for name, text in texts if text]
    return "\n".join(parts[:2]) + "\n\n" + "\n\n".join(parts[2:]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--source", type=Path, required=True, help="the source tree")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("binaries", nargs="+", help="programs and shared libraries")
    arguments = parser.parse_args()
    arguments.output.write_text(notices(arguments.binaries, arguments.source))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Each rule of check_house.py fires on a tree that breaks it, and is silent on one that does not."""

import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

sys.dont_write_bytecode = True  # no folder of compiled files in the working tree
import check_house  # noqa: E402

LATER = "TO" + "DO"


FLOORS = [
    {"name": "core", "uses": []},
    {"name": "scene", "uses": ["core"]},
    {"name": "demo", "uses": ["scene"]},
    {"name": "gaussians", "uses": ["scene"]},
    {"name": "render", "uses": ["gaussians"]},
    {"name": "networks", "uses": ["scene"]},
    {"name": "stages", "uses": ["render", "networks"]},
]


def violations(files):
    """`file:line: what` for a tree of the given files."""
    with tempfile.TemporaryDirectory() as root:
        for name, text in files.items():
            path = Path(root, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return ["{}:{}: {}".format(*v) for v in check_house.House(Path(root), FLOORS).check()]


@mock.patch.object(check_house, "WITHOUT_TEST", {})
class CheckHouseTest(unittest.TestCase):
    def assert_refused(self, files, *wanted):
        found = violations(files)
        self.assertEqual(len(found), len(wanted), found)
        for line, want in zip(found, sorted(wanted)):
            self.assertTrue(line.startswith(want), f"{line!r} does not start with {want!r}")

    def assert_accepted(self, files):
        self.assertEqual(violations(files), [])

    def test_british_spelling(self):
        self.assert_refused(
            {"src/oraclegs/core/a.h": 'f("its colour");\n', "apps/oraclegs/b.h": 'f("greyer", "Greyhound");\nf("the licence");\n',
             "tests/core/a_test.cpp": "// the centre\nint neighbours;\nNormaliseAll();\n",
             "docs/c.md": "# Colours\nThe `centre`\n\n    a grey example\n", "README.md": "neighbours\n"},
            "src/oraclegs/core/a.h:1: colour", "apps/oraclegs/b.h:1: grey", "apps/oraclegs/b.h:2: licence", "tests/core/a_test.cpp:1: centre",
            "tests/core/a_test.cpp:2: neighbour", "tests/core/a_test.cpp:3: Normalise",
            "docs/c.md:1: Colour", "docs/c.md:2: centre", "docs/c.md:4: grey", "README.md:1: neighbour")  # fmt: skip
        self.assert_accepted({
            "src/oraclegs/core/a.h": 'f("neighbors", "colour", "Greyhound");  // parameter, promise\n',
            "docs/c.md": "[link](#colors), raised noises, optimistic organisms\n",
        })

    def test_headless_doc_comment(self):
        self.assert_refused(
            {"src/oraclegs/core/a.h": "/// Of a view.\nint a;  ///< The same of pixels\n/// A view. What is left is cut.\n"},
            "src/oraclegs/core/a.h:1: \"Of", "src/oraclegs/core/a.h:2: \"The same", "src/oraclegs/core/a.h:3: \"What")  # fmt: skip
        self.assert_accepted({"src/oraclegs/core/a.h": "/// Pixels\n/// of a view, what is left.\n// What follows is code.\n"})

    def test_good_tree_passes(self):
        self.assert_accepted({
            "src/oraclegs/networks/common/tensor.h": "#include <torch/types.h>\n",
            "src/oraclegs/networks/vggt/vggt.h": '#include "oraclegs/networks/common/tensor.h"\n',
            "src/oraclegs/core/files.h": "#include <string>\n",
            "src/oraclegs/core/files.cpp": '#include "oraclegs/core/files.h"\n#include "oraclegs/core/config.h"\n',
            "src/oraclegs/render/cpu/blend.h": '#include "oraclegs/core/files.h"\n#include "oraclegs/scene/a.h"\n',
            "src/oraclegs/render/cuda/blend.cu": '#include "oraclegs/core/files.h"\n',
            "tests/core/files_test.cpp": "TEST(Files, Reads) {}\n",
            "apps/oraclegs/terminal.cpp": "std::cout << 1; std::exit(2);\n",
            "docs/method.md": "# Method\n## Blending\n",
            "docs/references.md": "- [Kerbl 2023] 3DGS\n",
        })

    def test_long_file(self):
        self.assert_accepted({"tests/core/a.h": "\n" * 500})
        for name in ["tests/core/a_test.cpp", "scripts/a.sh", "apps/oraclegs/a.cpp"]:
            self.assert_refused({name: "\n" * 501}, f"{name}:501: has 501 lines")

    def test_long_unit(self):
        halves = {"src/oraclegs/core/a.h": "\n" * 200, "src/oraclegs/core/a.cpp": "\n" * 200, "tests/core/a_test.cpp": ""}
        self.assert_accepted(halves)
        self.assert_refused({**halves, "src/oraclegs/core/a.h": "\n" * 201},
                            "src/oraclegs/core/a.cpp:1: the unit has 401 lines")

    def test_crowded_room(self):
        units = {f"src/oraclegs/stages/u{i}.h": "" for i in range(25)}
        self.assert_accepted(units)
        self.assert_refused({**units, "src/oraclegs/stages/more.h": ""},
                            "src/oraclegs/stages:1: has 26 units")

    def test_include_climbs_a_floor(self):
        names = [floor["name"] for floor in FLOORS]
        for low, high in zip(names, names[1:]):
            up = {f"src/oraclegs/{low}/a.h": f'\n#include "oraclegs/{high}/b.h"\n'}
            self.assert_refused(up, f"src/oraclegs/{low}/a.h:2: floor {low} includes from {high}")
        self.assert_refused({"src/oraclegs/gaussians/a.h": '#include "oraclegs/demo/b.h"\n'},
                            "src/oraclegs/gaussians/a.h:1: floor gaussians includes from demo")
        self.assert_refused({"src/oraclegs/render/a.h": '#define HWY_TARGET_INCLUDE "oraclegs/networks/b.h"\n'},
                            "src/oraclegs/render/a.h:1: floor render includes from networks")
        self.assert_refused({"src/oraclegs/core/a.h": '#include "oraclegs/attic/b.h"\n'},
                            "src/oraclegs/core/a.h:1: includes from attic")
        self.assert_accepted({"src/oraclegs/stages/a.h": '#include "oraclegs/core/b.h"\n'})

    def test_circle_of_units(self):
        circle = {"src/oraclegs/core/a.h": '#include "oraclegs/core/b.h"\n', "src/oraclegs/core/b.h": "",
                  "src/oraclegs/core/b.cpp": '#include "oraclegs/core/a.h"\n', "tests/core/b_test.cpp": ""}
        self.assert_refused(circle, "src/oraclegs/core/a.h:1: includes itself through src/oraclegs/core/b")

    def test_circle_of_rooms(self):
        rooms = {"src/oraclegs/networks/common/a.h": '#include "oraclegs/networks/vggt/b.h"\n',
                 "src/oraclegs/networks/vggt/b.h": "",
                 "src/oraclegs/networks/vggt/c.h": '#include "oraclegs/networks/common/d.h"\n',
                 "src/oraclegs/networks/common/d.h": ""}
        self.assert_refused(rooms, "src/oraclegs/networks/common:1: the room includes itself through")
        self.assert_accepted({"src/oraclegs/render/a.h": '#include "oraclegs/render/cuda/b.h"\n',
                              "src/oraclegs/render/cuda/b.h": '#include "oraclegs/render/c.h"\n',
                              "src/oraclegs/render/c.h": ""})

    def test_too_many_parameters(self):
        name = "src/oraclegs/core/a.h"
        self.assert_accepted({name: "int F(int a, int b, int c, int d, int e);\n"})
        self.assert_accepted({name: "  return F(a, b, c, d, e, f);\n  F(a, b, c, d, e, f);\n"})
        self.assert_refused({name: "\nint F(int a, const T& b,\n  int c, int d,\n  int e, std::map<int, int> f);\n"},
                            f"{name}:2: F has 6 parameters")

    def test_type_of_one_name(self):
        one = {"src/oraclegs/core/a.h": "namespace oraclegs {\nstruct Sample {\n};\n}  // namespace oraclegs\n"}
        self.assert_refused({**one, "src/oraclegs/scene/b.h": one["src/oraclegs/core/a.h"]},
                            "src/oraclegs/scene/b.h:2: Sample is also a type in src/oraclegs/core/a.h")
        own = "namespace oraclegs {\nnamespace {\nstruct Sample {\n};\n}  // namespace\n}  // namespace oraclegs\n"
        other = "namespace oraclegs::cuda {\nstruct Sample {\n};\n}  // namespace oraclegs::cuda\n"
        self.assert_accepted({**one, "src/oraclegs/scene/b.h": own, "src/oraclegs/scene/c.h": other,
                              "src/oraclegs/scene/d.h": "namespace oraclegs {\nstruct Sample;\n}\n"})

    def test_the_program_prints_in_one_place(self):
        for line in ["std::fputs(text, stdout);", "fprintf(stderr, text);", "std::cout << text;", "std::fwrite(a, 1, n, stdout);"]:
            self.assert_refused({"apps/oraclegs/a.cpp": line + "\n"}, "apps/oraclegs/a.cpp:1: ")
            self.assert_accepted({"apps/oraclegs/terminal.cpp": line + "\n"})
        self.assert_accepted({"apps/oraclegs/a.cpp": "WriteOut(text);\nstd::snprintf(text, n, format);\n"})

    def test_casts(self):
        for cast in ["const_cast", "dynamic_cast"]:
            self.assert_refused({"src/oraclegs/core/a.h": f"{cast}<T&>(x)\n"}, f"src/oraclegs/core/a.h:1: {cast}")
            self.assert_accepted({"src/oraclegs/core/a.h": f"{cast}<T&>(x)  // the C interface wants it\n"})

    def test_automatic_options(self):
        self.assert_refused(
            {"src/oraclegs/stages/a.h": "int n = asked.views.ValueOr(8);\n"},
            "src/oraclegs/stages/a.h:1: settles an automatic option")  # fmt: skip
        self.assert_accepted({"src/oraclegs/core/options.h": "T ValueOr(T decided) const;\nint n = asked.ValueOr(8);\n"})

    def test_citations(self):
        docs = {"docs/method.md": "# Method\n## MCMC: relocation\n", "docs/references.md": "- [Kerbl 2023] 3DGS\n"}
        name = "src/oraclegs/core/a.h"
        self.assert_accepted({**docs, name: "// docs/method.md#mcmc-relocation, [Kerbl 2023], docs/method.md\n"})
        for bad in ["docs/method.md#blending", "[Yu 2024]", "spec" + "/gaussian_core.md", "(8" + ".2)", "[3D" + "GS]",
                    "../sha" + "red/data"]:
            self.assert_refused({**docs, name: f"// see {bad}\n"}, f"{name}:1: ")
        self.assert_refused({**docs, "README.md": "the protocol of [Yu 2024]\n"}, "README.md:1: docs/references.md has no")

    def test_history_in_pages(self):
        for bad in ["since issue 12", "see #18", "at 7e850" + "ae", "commit 1234567"]:
            self.assert_refused({"docs/a.md": f"{bad}\n"}, "docs/a.md:1: ")
        self.assert_accepted({"docs/a.md": "[page](method.md#blending), 1000000 points, a color #fff0aa, C#\n"})

    def test_unknown_floor(self):
        self.assert_refused({"src/oraclegs/attic/a.h": "\n"}, "src/oraclegs/attic/a.h:1: is on no floor")
        self.assert_refused({"src/other/a.h": "\n"}, "src/other/a.h:1: is on no floor")

    def test_torch_where_it_must_not_be(self):
        for name in ["core/a.h", "scene/a.h", "networks/a.h", "render/a.cu", "render/a.cuh"]:
            for header in ["torch/types.h", "ATen/ATen.h", "c10/core/Device.h"]:
                self.assert_refused({f"src/oraclegs/{name}": f"#include <{header}>\n"},
                                    f"src/oraclegs/{name}:1: <{header}> brings libtorch")
        self.assert_accepted({"src/oraclegs/networks/vggt/a.h": "#include <torch/types.h>\n"})

    def test_torch_through_another_header(self):
        tensor = {"src/oraclegs/networks/common/tensor.h": "#include <torch/types.h>\n",
                  "src/oraclegs/networks/vggt/v.h": '#include "oraclegs/networks/common/tensor.h"\n'}
        self.assert_refused({**tensor, "src/oraclegs/stages/a.h": '#include "oraclegs/networks/vggt/v.h"\n'},
                            "src/oraclegs/stages/a.h:1: <oraclegs/networks/vggt/v.h> brings libtorch into stages")

    def test_printing_and_exiting(self):
        bad = ["std::cout << 1;", "std::cerr << 1;", 'printf("x");', 'std::fprintf(stderr, "x");', 'puts("x");',
               "exit(1);", "std::exit(1);", "_exit(1);", "abort();", 'fmt::print("x");']
        for line in bad:
            self.assert_refused({"src/oraclegs/core/a.h": f"\n  {line}\n"}, "src/oraclegs/core/a.h:2: ")
        good = ['snprintf(b, 1, "x");', "// exit(1) and std::cout", 'Say("std::cout, exit(1)");', "OnExit(1);",
                "child.exit(1);", "child->exit(1);", "int exit_code() const;"]
        for line in good:
            self.assert_accepted({"src/oraclegs/core/a.h": f"{line}\n"})

    def test_skipped_tests(self):
        name = "tests/core/a_test.cpp"
        self.assert_refused({name: "GTEST_SKIP();\n"}, f"{name}:1: GTEST_SKIP")
        self.assert_accepted({name: 'GTEST_SKIP() << "needs an NVIDIA GPU";\n'})
        self.assert_refused({name: "\nTEST(A, DISABLED_B) {}\n"}, f"{name}:2: a DISABLED_ test")
        self.assert_accepted({name: "// Needs 64 GB.\nTEST(A, DISABLED_B) {}\n"})

    def test_source_without_test(self):
        source = {"src/oraclegs/render/cpu/blend.cpp": "\n"}
        self.assert_refused(source, "src/oraclegs/render/cpu/blend.cpp:1: has no test")
        self.assert_refused({**source, "tests/core/blend_test.cpp": "\n"}, "src/oraclegs/render/cpu/blend.cpp:1: has no")
        for test in ["render/blend_test.cpp", "render/cpu/blend_test.cpp", "render/blend_golden_test.cpp"]:
            self.assert_accepted({**source, f"tests/{test}": "\n"})

    def test_excused_source(self):
        with mock.patch.object(check_house, "WITHOUT_TEST", {"core/a.cpp": "reason"}):
            self.assert_accepted({"src/oraclegs/core/a.cpp": "\n"})
            self.assert_refused({}, "scripts/check_house.py:1: core/a.cpp is excused")

    def test_notes_for_later(self):
        for name in ["src/oraclegs/core/a.h", "tests/core/a_test.cpp", "scripts/a.sh", "cmake/A.cmake"]:
            self.assert_refused({name: f"// {LATER}: later\n"}, f"{name}:1: {LATER}")

    def test_deep_folder(self):
        self.assert_accepted({"src/oraclegs/render/cpu/x/a.h": "\n"})
        self.assert_refused({"src/oraclegs/render/cpu/x/y/a.h": "\n"}, "src/oraclegs/render/cpu/x/y/a.h:1: lies 5")


if __name__ == "__main__":
    unittest.main()

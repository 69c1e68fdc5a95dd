#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants one mistake of each kind in a small clean tree and expects it to be named."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parent / "include_rules.py"
SPDX = "// SPDX-License-Identifier: Apache-2.0\n"
HPP = SPDX + "#pragma once\n"

INCLUDE = "framework/include/weft/"
CLEAN = {
    "CMakeLists.txt": "# SPDX-License-Identifier: Apache-2.0\n",
    "scripts/test.sh": "#!/bin/sh\n# SPDX-License-Identifier: Apache-2.0\n",
    INCLUDE + "abi.h": "/* SPDX-License-Identifier: Apache-2.0 */\n#include <stdint.h>\n",
    INCLUDE + "core/result.hpp": HPP + "#include <string>\n",
    INCLUDE + "core/params.hpp": HPP + "#include <weft/abi.h>\n",
    INCLUDE + "data/image.hpp": HPP + "#include <weft/core/result.hpp>\n",
    INCLUDE + "geometry/mesh.hpp": HPP + "#include <Eigen/Core>\n#include <weft/data/image.hpp>\n",
    INCLUDE + "sdk/filter.hpp": HPP + "#include <weft/abi.h>\n#include <weft/geometry/mesh.hpp>\n",
    INCLUDE + "testing/contract.hpp": HPP + "#include <gtest/gtest.h>\n#include <weft/sdk/filter.hpp>\n",
    INCLUDE + "host/registry.hpp": HPP + '#include "weft/sdk/filter.hpp"\n',
    INCLUDE + "pipeline/graph.hpp": HPP + "#include <weft/host/registry.hpp>\n",
    INCLUDE + "evaluation/metrics.hpp": HPP + "#include <weft/pipeline/graph.hpp>\n",
    "framework/src/host/reader.hpp": HPP,
    "framework/src/host/library.cpp": SPDX
    + '#include "reader.hpp"\n#include <boost/dll.hpp>\n#include <yaml-cpp/yaml.h>\n'
    + 'const char* help = "std::cout << 1";  // printf("x")\n'
    + "int n = std::snprintf(buffer, 9, format);\ndup2(fd, STDERR_FILENO);\n",
    "framework/src/host/describe_main.cpp": SPDX + "int main() { std::puts(text); }\n",
    "framework/src/testing/synthetic.cpp": SPDX + "#include <opencv2/core.hpp>\n",
    "cli/main.cpp": SPDX
    + "#include <weft/evaluation/metrics.hpp>\nint main() { std::cout << 1; }\n",
    "plugins/filters/near/near.hpp": HPP,
    "plugins/filters/near/near.cpp": SPDX
    + '#include "near.hpp"\n#include <CGAL/Delaunay.h>\n#include <weft/sdk/filter.hpp>\n',
    "plugins/filters/near/tests/near_test.cpp": SPDX
    + '#include <gtest/gtest.h>\n#include <weft/testing/contract.hpp>\n#include "near.hpp"\n'
    + 'int seed = std::printf("seed");\n',
    "plugins/sources/common/lens.hpp": HPP + "#include <weft/data/image.hpp>\n",
    "plugins/sources/images/camera.cpp": SPDX
    + '#include "common/lens.hpp"\n#include <yaml-cpp/yaml.h>\n',
    "plugins/sources/images/camera.hpp": HPP,
    "plugins/detectors/pair/pair.cpp": SPDX
    + '#include "common/lens.hpp"\n#include <weft/sdk/source.hpp>\n'
    + 'WEFT_LIBRARY(WEFT_COMPONENT(Pair, "detectors/pair", "1", ""),\n'
    + '             WEFT_COMPONENT(Other,\n "sources/pair", "1", ""))\n',
    "tests/unit/host/registry_test.cpp": SPDX + "#include <weft/host/registry.hpp>\n",
}

# File, text appended to it (or its whole text if it is new), words that the rule must contain.
NEAR = "plugins/filters/near/near.cpp"
NEAR_TEST = "plugins/filters/near/tests/near_test.cpp"
MISTAKES = {
    "core on data": (INCLUDE + "core/result.hpp", "#include <weft/data/image.hpp>", "core must not"),
    "data on geometry": (INCLUDE + "data/image.hpp", "#include <weft/geometry/mesh.hpp>", "data must"),
    "geometry on sdk": (INCLUDE + "geometry/mesh.hpp", "#include <weft/sdk/filter.hpp>", "geometry"),
    "sdk on host": (INCLUDE + "sdk/filter.hpp", "#include <weft/host/registry.hpp>", "sdk must not"),
    "sdk on testing": (INCLUDE + "sdk/filter.hpp", "#include <weft/testing/contract.hpp>", "sdk must"),
    "testing on pipeline": (
        INCLUDE + "testing/contract.hpp",
        "#include <weft/pipeline/graph.hpp>",
        "testing must not",
    ),
    "host on pipeline": (INCLUDE + "host/registry.hpp", "#include <weft/pipeline/graph.hpp>", "host"),
    "host on testing": (INCLUDE + "host/registry.hpp", "#include <weft/testing/contract.hpp>", "host"),
    "pipeline on evaluation": (
        "framework/src/pipeline/graph.cpp",
        SPDX + '#include "weft/evaluation/metrics.hpp"',
        "pipeline must not",
    ),
    "evaluation on the program": (
        "framework/src/evaluation/metrics.cpp",
        SPDX + '#include "../../../cli/main.cpp"',
        "evaluation must not",
    ),
    "private header of a higher layer": (
        "framework/src/core/result.cpp",
        SPDX + '#include "host/reader.hpp"',
        "core must not",
    ),
    "spaced include": (INCLUDE + "core/result.hpp", "#  include  <weft/sdk/filter.hpp>", "core must"),
    "file outside the layers": (INCLUDE + "weft.hpp", HPP, "stands in no layer"),
    "file outside the plugins": ("plugins/filters/shared.hpp", HPP, "stands in no layer"),
    "abi.h on core": (INCLUDE + "abi.h", "#include <weft/core/result.hpp>", "abi.h must not"),
    "data on abi.h": (INCLUDE + "data/image.hpp", "#include <weft/abi.h>", "must not include weft/abi"),
    "pipeline on abi.h": (INCLUDE + "pipeline/graph.hpp", "#include <weft/abi.h>", "must not include"),
    "plugin on abi.h": (NEAR, "#include <weft/abi.h>", "must not include weft/abi.h"),
    "plugin on host": (NEAR, "#include <weft/host/registry.hpp>", "a plugin must not"),
    "plugin on pipeline": (NEAR, "#include <weft/pipeline/graph.hpp>", "a plugin must not"),
    "plugin on evaluation": (NEAR, "#include <weft/evaluation/metrics.hpp>", "a plugin must not"),
    "plugin on testing": (NEAR, "#include <weft/testing/contract.hpp>", "only the tests of a plugin"),
    "plugin on GoogleTest": (NEAR, "#include <gtest/gtest.h>", "GoogleTest"),
    "plugin on a private header": (NEAR, '#include "../../../framework/src/host/reader.hpp"', "(host)"),
    "plugin test on host": (NEAR_TEST, "#include <weft/host/registry.hpp>", "a plugin must not"),
    "plugin on plugin, by path": (NEAR, '#include "../../sources/images/camera.hpp"', "another plugin"),
    "plugin on plugin, by folder": (NEAR, "#include <sources/images/camera.hpp>", "another plugin"),
    "plugin on plugin, by name": (NEAR, '#include "camera.hpp"', "another plugin"),
    "plugin on another role's common folder": (NEAR, '#include "common/lens.hpp"', "another plugin"),
    "common folder on a plugin": (
        "plugins/sources/common/lens.hpp",
        '#include "images/camera.hpp"',
        "another plugin",
    ),
    "plugin on a missing plugin": (NEAR, '#include "../far/far.hpp"', "another plugin"),
    "yaml-cpp in sdk": (INCLUDE + "sdk/filter.hpp", "#include <yaml-cpp/yaml.h>", "yaml-cpp"),
    "yaml-cpp in an installed header": (
        INCLUDE + "host/registry.hpp",
        "#include <yaml-cpp/yaml.h>",
        "yaml-cpp",
    ),
    "yaml-cpp in a filter": (NEAR, "#include <yaml-cpp/yaml.h>", "yaml-cpp"),
    "Boost.DLL in pipeline": (
        "framework/src/pipeline/graph.cpp",
        SPDX + "#include <boost/dll/shared_library.hpp>",
        "Boost.DLL",
    ),
    "Boost in an installed header": (INCLUDE + "host/registry.hpp", "#include <boost/any.hpp>", "Boost"),
    "CGAL in geometry": (INCLUDE + "geometry/mesh.hpp", "#include <CGAL/Origin.h>", "CGAL"),
    "Embree in host": ("framework/src/host/library.cpp", "#include <embree3/rtcore.h>", "Embree"),
    "Ceres in evaluation": (
        "framework/src/evaluation/fit.cpp",
        SPDX + "#include <ceres/ceres.h>",
        "Ceres",
    ),
    "OpenCL in sdk": (INCLUDE + "sdk/filter.hpp", "#include <CL/opencl.hpp>", "OpenCL"),
    "OpenCV in data": (INCLUDE + "data/image.hpp", "#include <opencv2/core.hpp>", "OpenCV"),
    "OpenCV in the program": ("cli/main.cpp", "#include <opencv2/core.hpp>", "OpenCV"),
    "fmt in geometry": (INCLUDE + "geometry/mesh.hpp", "#include <fmt/core.h>", "Eigen only"),
    "cout in host": ("framework/src/host/library.cpp", "void f() { std::cout << 1; }", "cout"),
    "cerr in a plugin": (NEAR, "void f() { std :: cerr << 1; }", "cerr"),
    "printf in a plugin": (NEAR, 'void f() { printf("x"); }', "printf"),
    "puts in an installed header": (INCLUDE + "core/result.hpp", "inline int f = std::puts(s);", "puts"),
    "fprintf to stderr": (NEAR, 'void f() { std::fprintf(stderr, "x"); }', "stderr"),
    "fmt::print": (NEAR, 'void f() { fmt::print("x"); }', "fmt::print"),
    "print after a raw string": (NEAR, 'auto s = R"(")"; auto n = puts(s); // "', "puts"),
    "no licence": (NEAR.replace("near.cpp", "far.cpp"), "int n;", "SPDX"),
    "no licence in a script": ("scripts/x.py", "#!/usr/bin/env python3\n\n", "SPDX"),
    "no pragma": (INCLUDE + "core/rng.hpp", SPDX + "int n;", "#pragma once"),
}


def write(root: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def run(*arguments: str) -> subprocess.CompletedProcess:
    command = [sys.executable, str(SCRIPT), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


class IncludeRules(unittest.TestCase):
    def test_accepts_a_clean_tree(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder), CLEAN)
            result = run(folder)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertIn("0 violations", result.stdout)

    def test_names_each_planted_mistake_and_nothing_else(self) -> None:
        for name, (file, text, words) in MISTAKES.items():
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                before = CLEAN.get(file, "")
                write(Path(folder), {**CLEAN, file: before + text + "\n"})
                result = run(folder)
                self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
                violations = result.stdout.splitlines()[:-1]
                self.assertEqual(len(violations), 1, result.stdout)
                self.assertRegex(violations[0], rf"^{file}:\d+: ")
                self.assertIn(words, violations[0])
                if before:
                    line = before.count("\n") + 1
                    self.assertTrue(violations[0].startswith(f"{file}:{line}: "), violations[0])

    def test_reports_all_mistakes_in_one_pass(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            text = CLEAN[NEAR] + "#include <gtest/gtest.h>\n#include <weft/abi.h>\n"
            write(Path(folder), {**CLEAN, NEAR: text, "plugins/filters/near/bad.hpp": "int n;\n"})
            result = run(folder)
            self.assertIn("4 violations", result.stdout)

    def test_ignores_commented_includes_and_build_folders(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            comments = "// #include <gtest/gtest.h>\n/*\n#include <weft/abi.h>\n*/\n"
            built = {"framework/build-x/made.cpp": "int n;\n", "plugins/a/.cache/x.hpp": "int n;\n"}
            write(Path(folder), {**CLEAN, NEAR: CLEAN[NEAR] + comments, **built})
            result = run(folder)
            self.assertEqual(result.returncode, 0, result.stdout)

    def test_refuses_a_folder_that_is_not_the_tree(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(run(folder).returncode, 2)
        self.assertEqual(run().returncode, 2)


if __name__ == "__main__":
    unittest.main()

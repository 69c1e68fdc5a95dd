#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants one mistake of each kind in a small clean tree and expects it to be named."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import include_rules

SCRIPT = Path(__file__).resolve().parent / "include_rules.py"
SPDX = "// SPDX-License-Identifier: Apache-2.0\n"
HPP = SPDX + "#pragma once\n"

INCLUDE = "framework/include/weft/"
ROOMS = "framework/"
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
    ROOMS + "yaml/yaml.hpp": HPP,
    ROOMS + "yaml/yaml.cpp": SPDX + '#include "yaml/yaml.hpp"\n#include <yaml-cpp/yaml.h>\n',
    ROOMS + "host/loading/registry.hpp": HPP + '#include "yaml/yaml.hpp"\n#include <weft/abi.h>\n',
    ROOMS + "host/loading/library.cpp": SPDX
    + '#include "host/loading/registry.hpp"\n#include <boost/dll.hpp>\n'
    + 'const char* help = "std::cout << 1";  // printf("x")\n'
    + "int n = std::snprintf(buffer, 9, format);\ndup2(fd, STDERR_FILENO);\n",
    ROOMS + "host/calling/execution_context.hpp": HPP + '#include "host/loading/registry.hpp"\n',
    ROOMS + "pipeline/configuration/config.hpp": HPP + '#include "host/loading/registry.hpp"\n',
    ROOMS + "pipeline/graph/graph.hpp": HPP + '#include "pipeline/configuration/config.hpp"\n',
    ROOMS + "pipeline/execution/executor.hpp": HPP + '#include "pipeline/graph/graph.hpp"\n',
    ROOMS + "pipeline/runs/run.hpp": HPP + '#include "pipeline/execution/executor.hpp"\n',
    ROOMS + "lab/statistics/friedman.hpp": HPP + "#include <weft/core/result.hpp>\n",
    ROOMS + "lab/metrics/metrics.hpp": HPP + '#include "lab/statistics/friedman.hpp"\n',
    ROOMS + "lab/results/cell_record.hpp": HPP + '#include "lab/metrics/metrics.hpp"\n',
    ROOMS + "lab/ablation/plan/plan.hpp": HPP + '#include "lab/results/cell_record.hpp"\n',
    ROOMS + "lab/ablation/ablation.hpp": HPP + '#include "lab/ablation/plan/plan.hpp"\n',
    ROOMS + "lab/report/report.hpp": HPP + '#include "lab/results/cell_record.hpp"\n',
    ROOMS + "host/probing/main.cpp": SPDX + "int main() { std::puts(text); }\n",
    ROOMS + "kit/testing/synthetic.cpp": SPDX
    + '#include <opencv2/core.hpp>\n#include "host/calling/execution_context.hpp"\n',
    ROOMS + "cli/main.cpp": SPDX
    + '#include "lab/report/report.hpp"\nint main() { std::cout << 1; }\n',
    "plugins/filters/near/near.hpp": HPP,
    "plugins/filters/near/near.cpp": SPDX
    + '#include "near.hpp"\n#include <CGAL/Delaunay.h>\n#include <weft/sdk/filter.hpp>\n',
    "plugins/filters/near/tests/near_test.cpp": SPDX
    + '#include <gtest/gtest.h>\n#include <weft/testing/contract.hpp>\n#include "near.hpp"\n'
    + 'int seed = std::printf("seed");\n',
    "plugins/sources/common/lens.hpp": HPP + "#include <weft/data/image.hpp>\n",
    "plugins/sources/images/camera.cpp": SPDX
    + '#include "common/lens.hpp"\n#include <yaml-cpp/yaml.h>\n',
    "plugins/common/scene/rays.hpp": HPP + "#include <embree3/rtcore.h>\n",
    "plugins/passes/sight/sight.cpp": SPDX + '#include "common/scene/rays.hpp"\n',
    "plugins/sources/images/camera.hpp": HPP,
    "plugins/detectors/pair/pair.cpp": SPDX
    + '#include "common/lens.hpp"\n#include <weft/sdk/source.hpp>\n'
    + 'WEFT_LIBRARY(WEFT_COMPONENT(Pair, "detectors/pair", "1", ""),\n'
    + '             WEFT_COMPONENT(Other,\n "sources/pair", "1", ""))\n',
    "tests/unit/host/registry_test.cpp": SPDX + '#include "host/loading/registry.hpp"\n',
}

# File, text appended to it (or its whole text if it is new), words that the rule must contain.
NEAR = "plugins/filters/near/near.cpp"
NEAR_TEST = "plugins/filters/near/tests/near_test.cpp"
MISTAKES = {
    "core on data": (INCLUDE + "core/result.hpp", "#include <weft/data/image.hpp>", "core must not"),
    "data on geometry": (INCLUDE + "data/image.hpp", "#include <weft/geometry/mesh.hpp>", "data must"),
    "geometry on sdk": (INCLUDE + "geometry/mesh.hpp", "#include <weft/sdk/filter.hpp>", "geometry"),
    "sdk on a room": (INCLUDE + "sdk/filter.hpp", '#include "host/calling/execution_context.hpp"', "sdk must not"),
    "sdk on testing": (INCLUDE + "sdk/filter.hpp", "#include <weft/testing/contract.hpp>", "sdk must"),
    "an installed test header on a room": (
        INCLUDE + "testing/contract.hpp",
        '#include "host/calling/execution_context.hpp"',
        "testing must not",
    ),
    "yaml on host": (ROOMS + "yaml/yaml.cpp", '#include "host/calling/execution_context.hpp"', "yaml must not"),
    "loading on calling": (
        ROOMS + "host/loading/library.cpp",
        '#include "host/calling/execution_context.hpp"',
        "host/loading must not",
    ),
    "host on pipeline": (
        ROOMS + "host/calling/execution_context.hpp",
        '#include "pipeline/graph/graph.hpp"',
        "host/calling must not",
    ),
    "configuration on the graph": (
        ROOMS + "pipeline/configuration/config.hpp",
        '#include "pipeline/graph/graph.hpp"',
        "pipeline/configuration must not",
    ),
    "graph on execution": (
        ROOMS + "pipeline/graph/graph.hpp",
        '#include "pipeline/execution/executor.hpp"',
        "pipeline/graph must not",
    ),
    "pipeline on metrics": (
        ROOMS + "pipeline/runs/run.hpp",
        '#include "lab/metrics/metrics.hpp"',
        "pipeline/runs must not",
    ),
    "statistics on metrics": (
        ROOMS + "lab/statistics/friedman.hpp",
        '#include "lab/metrics/metrics.hpp"',
        "lab/statistics must not",
    ),
    "metrics on results": (
        ROOMS + "lab/metrics/metrics.hpp",
        '#include "lab/results/cell_record.hpp"',
        "lab/metrics must not",
    ),
    "results on ablation": (
        ROOMS + "lab/results/cell_record.hpp",
        '#include "lab/ablation/ablation.hpp"',
        "lab/results must not",
    ),
    "a plan on its engine": (
        ROOMS + "lab/ablation/plan/plan.hpp",
        '#include "lab/ablation/ablation.hpp"',
        "lab/ablation/plan must not",
    ),
    "ablation on report": (
        ROOMS + "lab/ablation/ablation.hpp",
        '#include "lab/report/report.hpp"',
        "lab/ablation must not",
    ),
    "report on ablation": (
        ROOMS + "lab/report/report.hpp",
        '#include "lab/ablation/ablation.hpp"',
        "lab/report must not",
    ),
    "report on the program": (
        ROOMS + "lab/report/report.hpp",
        '#include "cli/main.cpp"',
        "lab/report must not",
    ),
    "an installed header on a room, by path": (
        INCLUDE + "core/result.hpp",
        '#include "../../../yaml/yaml.hpp"',
        "core must not",
    ),
    "installed header in quotes": (
        ROOMS + "yaml/yaml.cpp",
        '#include "weft/core/result.hpp"',
        "as <weft/core/result.hpp>",
    ),
    "header of a room without its room": (
        ROOMS + "host/loading/library.cpp",
        '#include "registry.hpp"',
        "ROOM/registry.hpp",
    ),
    "spaced include": (INCLUDE + "core/result.hpp", "#  include  <weft/sdk/filter.hpp>", "core must"),
    "file outside the rooms": (INCLUDE + "weft.hpp", HPP, "stands in no room"),
    "file in a room that is not planned": (ROOMS + "host/new/lane.hpp", HPP, "stands in no room"),
    "file outside the plugins": ("plugins/filters/shared.hpp", HPP, "stands in no room"),
    "abi.h on core": (INCLUDE + "abi.h", "#include <weft/core/result.hpp>", "abi.h must not"),
    "data on abi.h": (INCLUDE + "data/image.hpp", "#include <weft/abi.h>", "must not include weft/abi"),
    "pipeline on abi.h": (ROOMS + "pipeline/graph/graph.hpp", "#include <weft/abi.h>", "must not include"),
    "plugin on abi.h": (NEAR, "#include <weft/abi.h>", "must not include weft/abi.h"),
    "plugin on host": (NEAR, '#include "host/loading/registry.hpp"', "a plugin must not"),
    "plugin on pipeline": (NEAR, '#include "pipeline/graph/graph.hpp"', "a plugin must not"),
    "plugin on metrics": (NEAR, '#include "lab/metrics/metrics.hpp"', "a plugin must not"),
    "plugin on testing": (NEAR, "#include <weft/testing/contract.hpp>", "only the tests of a plugin"),
    "plugin on GoogleTest": (NEAR, "#include <gtest/gtest.h>", "GoogleTest"),
    "plugin on a room, by path": (NEAR, '#include "../../../framework/yaml/yaml.hpp"', "(yaml)"),
    "plugin test on host": (NEAR_TEST, '#include "host/loading/registry.hpp"', "a plugin must not"),
    "plugin on plugin, by path": (NEAR, '#include "../../sources/images/camera.hpp"', "another plugin"),
    "plugin on plugin, by folder": (NEAR, "#include <sources/images/camera.hpp>", "another plugin"),
    "plugin on plugin, by name": (NEAR, '#include "camera.hpp"', "another plugin"),
    "plugin on another role's common folder": (NEAR, '#include "common/lens.hpp"', "another plugin"),
    "common folder on a plugin": (
        "plugins/sources/common/lens.hpp",
        '#include "images/camera.hpp"',
        "another plugin",
    ),
    "shared code on a plugin": (
        "plugins/common/scene/rays.hpp",
        '#include "near.hpp"',
        "another plugin",
    ),
    "plugin on a missing plugin": (NEAR, '#include "../far/far.hpp"', "another plugin"),
    "yaml-cpp in sdk": (INCLUDE + "sdk/filter.hpp", "#include <yaml-cpp/yaml.h>", "yaml-cpp"),
    "yaml-cpp in host": (
        ROOMS + "host/loading/registry.hpp",
        "#include <yaml-cpp/yaml.h>",
        "yaml-cpp",
    ),
    "yaml-cpp in a filter": (NEAR, "#include <yaml-cpp/yaml.h>", "yaml-cpp"),
    "Boost.DLL in pipeline": (
        ROOMS + "pipeline/graph/graph.cpp",
        SPDX + "#include <boost/dll/shared_library.hpp>",
        "Boost.DLL",
    ),
    "Boost in an installed header": (INCLUDE + "core/result.hpp", "#include <boost/any.hpp>", "Boost"),
    "CGAL in geometry": (INCLUDE + "geometry/mesh.hpp", "#include <CGAL/Origin.h>", "CGAL"),
    "Embree in host": (ROOMS + "host/loading/library.cpp", "#include <embree3/rtcore.h>", "Embree"),
    "Ceres in metrics": (
        ROOMS + "lab/metrics/fit.cpp",
        SPDX + "#include <ceres/ceres.h>",
        "Ceres",
    ),
    "OpenCL in sdk": (INCLUDE + "sdk/filter.hpp", "#include <CL/opencl.hpp>", "OpenCL"),
    "OpenCV in data": (INCLUDE + "data/image.hpp", "#include <opencv2/core.hpp>", "OpenCV"),
    "OpenCV in the program": (ROOMS + "cli/main.cpp", "#include <opencv2/core.hpp>", "OpenCV"),
    "fmt in geometry": (INCLUDE + "geometry/mesh.hpp", "#include <fmt/core.h>", "Eigen only"),
    "cout in host": (ROOMS + "host/loading/library.cpp", "void f() { std::cout << 1; }", "cout"),
    "cerr in a plugin": (NEAR, "void f() { std :: cerr << 1; }", "cerr"),
    "printf in a plugin": (NEAR, 'void f() { printf("x"); }', "printf"),
    "puts in an installed header": (INCLUDE + "core/result.hpp", "inline int f = std::puts(s);", "puts"),
    "fprintf to stderr": (NEAR, 'void f() { std::fprintf(stderr, "x"); }', "stderr"),
    "fmt::print": (NEAR, 'void f() { fmt::print("x"); }', "fmt::print"),
    "print after a raw string": (NEAR, 'auto s = R"(")"; auto n = puts(s); // "', "puts"),
    "no licence": (NEAR.replace("near.cpp", "far.cpp"), "int n;", "SPDX"),
    "no licence in a script": ("scripts/x.py", "#!/usr/bin/env python3\n\n", "SPDX"),
    
    "a long header": (ROOMS + "yaml/long.hpp", HPP + "\n" * 199, "more than 200 lines"),
    "no pragma": (INCLUDE + "core/rng.hpp", SPDX + "int n;", "#pragma once"),
}


def write(root: Path, files: dict[str, str]) -> None:
    """Writes the files, and a README for each of their rooms that is not among them."""
    pages = {}
    for name in files:
        room = include_rules.scope_of(name)
        if room in include_rules.LAYERS:
            pages[include_rules.folder_of(room) + "/README.md"] = "\n\n".join(include_rules.lists_of(room)) + "\n"
    for name, text in {**pages, **files}.items():
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

    def test_names_a_folder_with_too_many_sources_and_a_room_without_a_page(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            many = {f"plugins/filters/near/part_{i}.hpp": HPP for i in range(24)}
            write(Path(folder), {**CLEAN, **many})
            (Path(folder) / ROOMS / "yaml" / "README.md").unlink()
            result = run(folder)
            self.assertIn("plugins/filters/near:1: has 26 sources", result.stdout)
            self.assertIn(ROOMS + "yaml/README.md:1: is missing", result.stdout)
            self.assertIn("2 violations", result.stdout)

    def test_names_what_the_page_of_a_room_says_wrong(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            page = ROOMS + "yaml/README.md"
            write(Path(folder), {**CLEAN, page: "May include: `data`.\n"})
            result = run(folder)
            self.assertIn(f"{page}:1: must say 'May include: `core`.'", result.stdout)
            self.assertIn(f"{page}:1: must say 'Included by: ", result.stdout)

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

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants mistakes in what seems to be built and expects each to be named."""

import sys
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import notice  # noqa: E402

BOOST = "/usr/include/boost/polygon/voronoi.hpp"
CGAL = "/usr/include/CGAL/Origin.h"
GMP = "/usr/include/x86_64-linux-gnu/gmp.h"


def built(licence=notice.OWN, headers=(BOOST,), program=(), common=(), shared=("libc.so.6",)):
    return notice.Built(
        {"filters_near": {"filters/near": licence}},
        {"filters_near": set(headers), notice.PROGRAM: set(program), "plugins/filters/common": set(common)},
        {"filters_near": set(shared), notice.PROGRAM: {"libfmt.so.9", "libstdc++.so.6"}})


class Notice(unittest.TestCase):
    def test_accepts_licences_that_are_those_of_what_is_used(self):
        self.assertEqual(list(notice.wrong_licences(built())), [])
        strict = built("GPL-3.0-or-later", [BOOST, CGAL])
        self.assertEqual(list(notice.wrong_licences(strict)), [])
        self.assertEqual(list(notice.wrong_licences(built(headers=[GMP]))), [])

    def test_names_a_component_that_hides_that_it_includes_a_library_under_the_gpl(self):
        found = list(notice.wrong_licences(built(headers=[CGAL])))
        self.assertEqual(len(found), 1)
        self.assertIn("filters/near uses CGAL 5.5, under the GPL, and its manifest says", found[0])

    def test_names_a_component_that_says_gpl_for_nothing(self):
        found = list(notice.wrong_licences(built("GPL-3.0-or-later")))
        self.assertEqual(found, ["filters/near says GPL-3.0-or-later but uses nothing under the GPL"])

    def test_keeps_the_gpl_out_of_the_program_and_of_common_folders(self):
        for room, planted in ((notice.PROGRAM, built(program=[CGAL])),
                              ("plugins/filters/common", built(common=[CGAL]))):
            self.assertEqual(list(notice.wrong_licences(planted)),
                             [f"{room} uses CGAL 5.5, under the GPL: keep that in a plugin"])

    def test_names_libraries_that_it_does_not_know(self):
        with mock.patch.object(notice, "packages_of", return_value={}):
            self.assertEqual(list(notice.unknown_libraries(built())), [])
            found = list(notice.unknown_libraries(built(shared=["libnew.so.1"])))
        self.assertEqual(len(found), 1)
        self.assertIn("filters_near links libnew.so.1", found[0])
        header = "/usr/include/new/new.h"
        with mock.patch.object(notice, "packages_of", return_value={header: "libnew-dev"}):
            found = list(notice.unknown_libraries(built(headers=[header])))
        self.assertEqual(len(found), 1)
        self.assertIn("filters_near includes headers of libnew-dev", found[0])

    def test_leaves_the_systems_headers_alone(self):
        system = "/usr/include/stdio.h"
        with mock.patch.object(notice, "packages_of", return_value={system: "libc6-dev"}):
            self.assertEqual(list(notice.unknown_libraries(built(headers=[system]))), [])

    def test_names_what_the_default_pipeline_must_not_have(self):
        pipeline = "stages:\n  - use: filters/near\n    params: {warp: {use: filters/near}}\n"
        self.assertEqual(list(notice.wrong_defaults(built(), pipeline)), [])
        self.assertIn("filters/near, of pipelines/demo.yaml, has GPL-3.0-or-later",
                      next(notice.wrong_defaults(built("GPL-3.0-or-later"), pipeline)))
        self.assertIn("not built", next(notice.wrong_defaults(built(), "use: warps/none")))

    def test_counts_objects_of_plugins_and_of_the_program_but_no_tests(self):
        of = notice.room_of
        self.assertEqual(of("plugins/filters/near/CMakeFiles/filters_near_objects.dir/near.cpp.o"),
                         "filters_near")
        self.assertIsNone(of("plugins/filters/near/CMakeFiles/filters_near_test.dir/a.cpp.o"))
        self.assertIsNone(of("framework/CMakeFiles/weft_testing.dir/a.cpp.o"))
        self.assertIsNone(of("tests/CMakeFiles/unit_core.dir/a.cpp.o"))
        self.assertEqual(of("framework/CMakeFiles/weft_host.dir/a.cpp.o"), notice.PROGRAM)
        self.assertEqual(of("plugins/filters/common/CMakeFiles/filters_common.dir/a.cpp.o"),
                         "plugins/filters/common")

    def test_lists_who_uses_what(self):
        text = notice.notice(built("GPL-3.0-or-later", [BOOST, CGAL]))
        self.assertIn("\n  GPL-3.0-or-later: filters/near\n", text)
        self.assertIn("\n  CGAL 5.5 (GPL-3.0-or-later)\n    all components\n", text)
        self.assertIn("\n  fmt (MIT)\n    the program\n", text)
        self.assertNotIn("OpenCL headers", text)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: Apache-2.0
import pathlib
import tempfile
import types
import unittest

import numpy as np
import weft
from my_plugin import MyPluginSink

PREDICTED = 3


def given(frame, state=1):
    shape = weft.Record(vertices_m=np.array([[0.1, -0.2, 0.5], [1 / 3, 0.0, 2.0]]), state=state,
                        source=np.array([1, 0], np.uint8))
    return types.SimpleNamespace(shape=shape, call=types.SimpleNamespace(frame=frame))


class MyPluginTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name) / "vertices"

    def written(self, *frames, **values):
        sink = MyPluginSink(path=str(self.folder), **values)
        sink.open(None)
        for each in frames:
            sink.write(each)
        return sorted(file.name for file in self.folder.iterdir())

    def test_writes_numbers_that_read_back_as_the_same(self):
        self.assertEqual(self.written(given(40)), ["000040.csv"])
        head, *lines = (self.folder / "000040.csv").read_text().splitlines()
        self.assertEqual(head, "x_m,y_m,z_m,measured")
        self.assertEqual([float(word) for word in lines[1].split(",")], [1 / 3, 0.0, 2.0, 0.0])

    def test_omits_older_shapes_by_default(self):
        self.assertEqual(self.written(given(0), given(1, PREDICTED)), ["000000.csv"])
        self.assertEqual(self.written(given(1, PREDICTED), measured_only=False), ["000000.csv", "000001.csv"])

    def test_says_that_a_folder_cannot_be_made(self):
        self.folder.write_text("in the way")
        with self.assertRaisesRegex(weft.Failure, "cannot be made .*: choose another 'path'"):
            self.written()


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: Apache-2.0
"""Does what docs/tutorials/my-poster-live.md says: poster_test.py BUILD ROOT

Its shell blocks are one script, in the page's order, which runs in an empty home folder whose `weft` is this
repository with its build. What a camera would take is played (played_camera.cpp), and where the surface was in
each frame is known: the shapes must lie on it. What is indented is for those who have a camera.
"""

import ast
import json
import math
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile

PAGE = "docs/tutorials/my-poster-live.md"
BLOCK = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)
# The page is served at an unused port. Each command of the page is recorded with the second at
# which it begins.
PRELUDE = """
exec 3> commands.txt
weft() {
  case $1 in
    live | run) command weft "$@" --set live.address=127.0.0.1:0 ;;
    *) command weft "$@" ;;
  esac
}
trap 'printf "%5d s  %s\\n" "$SECONDS" "$BASH_COMMAND" >&3' DEBUG
"""


def array_of(data):
    """The numbers of a .npy file of 64-bit floats."""
    length = struct.unpack("<H", data[8:10])[0]
    header = ast.literal_eval(data[10:10 + length].decode())
    if header["descr"] != "<f8" or header["fortran_order"]:
        raise ValueError(f"holds {header}, not rows of 64-bit floats")
    body = data[10 + length:]
    return struct.unpack(f"<{len(body) // 8}d", body)


def points_of(frame):
    """Vertices of a frame's shape in m, x y z in the camera frame."""
    with zipfile.ZipFile(frame) as file:
        numbers = array_of(file.read("shape/vertices_m.npy"))
    return list(zip(numbers[0::3], numbers[1::3], numbers[2::3]))


def on_poster(point, pose):
    """A point in the frame of the poster; `pose` has the rows of camera_from_poster, 3 x 4."""
    moved = [point[k] - pose[4 * k + 3] for k in range(3)]
    return [sum(pose[4 * k + i] * moved[k] for k in range(3)) for i in range(3)]


def off_surface(place, bend_per_m, width_m):
    """How far a point in the frame of the poster is off the cylinder on which the poster lies."""
    x, z = place[0] - width_m / 2, place[2]
    if bend_per_m < 1e-9:
        return abs(z)
    return abs(math.hypot(x, z - 1 / bend_per_m) - 1 / bend_per_m)


def mean(numbers):
    numbers = list(numbers)
    return sum(numbers) / len(numbers)


class MyPoster(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.home = pathlib.Path(folder.name)
        (self.home / "weft/build").mkdir(parents=True)
        (self.home / "weft/build/release").symlink_to(BUILD)
        (self.home / "weft/pipelines").symlink_to(ROOT / "pipelines")

    def type_page(self):
        """What the page's commands print, and the folder in which they work."""
        script = PRELUDE + "".join(BLOCK.findall((ROOT / PAGE).read_text(encoding="utf-8")))
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith("WEFT_") and not name.endswith("DISPLAY")}
        done = subprocess.run(["bash", "-eu", "-c", script], cwd=self.home,
                              env=environment | {"HOME": str(self.home)}, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, check=False)
        print((self.home / "commands.txt").read_text(encoding="utf-8"))
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout, self.home / "my_poster_live"

    def test_goes_from_a_photograph_to_live_tracking(self):
        said, folder = self.type_page()
        print(said)
        truth = json.loads((folder / "truth.json").read_text())
        self.expect_camera(folder, truth)
        self.expect_template(said, folder)
        self.expect_live(folder)
        self.expect_shapes(folder, truth)
        self.assertIn("<html", (folder / "tracked/report.html").read_text(encoding="utf-8"))

    def expect_camera(self, folder, truth):
        """Its focal length within 1 %, as the page says."""
        text = (folder / "camera.yaml").read_text()
        focal_px = float(re.search(r"^fx: (\S+)", text, re.MULTILINE)[1])
        self.assertAlmostEqual(focal_px / truth["fx"], 1.0, delta=0.01)

    def expect_template(self, said, folder):
        """Of a poster that was photographed as it should be nothing is doubtful."""
        self.assertNotIn("not calibrated", said)
        self.assertNotRegex(said, r"(?m)^warning   the texture is poor")
        for name in ("poster/corners.png", "my_poster/template.obj", "my_poster/texture.png",
                     "my_poster/camera.yaml"):
            self.assertTrue((folder / name).is_file(), name)

    def expect_live(self, folder):
        frames = [json.loads(line)
                  for line in (folder / "runs/live/frames.jsonl").read_text().splitlines()]
        self.assertIn("estimated", {frame["state"] for frame in frames})

    def expect_shapes(self, folder, truth):
        """Nine of ten frames have a shape, of which the mean vertex is within 1 cm of the surface, at the
        place that it has on it."""
        frames = [json.loads(line) for line in (folder / "tracked/frames.jsonl").read_text().splitlines()]
        self.assertEqual(len(frames), len(truth["frames"]))
        estimated = [frame["frame"] for frame in frames if frame["state"] == "estimated"]
        self.assertGreaterEqual(len(estimated), 0.9 * len(frames), [frame["state"] for frame in frames])
        width_m, height_m = truth["width_m"], truth["height_m"]
        worst_mm = 0.0
        for number in estimated:
            here = truth["frames"][number]
            places = [on_poster(point, here["camera_from_poster"])
                      for point in points_of(folder / f"tracked/frames/{number:06}.npz")]
            off_m = mean(off_surface(place, here["bend_per_m"], width_m) for place in places)
            aside_m = math.hypot(mean(place[0] for place in places) - width_m / 2,
                                 mean(place[1] for place in places) - height_m / 2)
            worst_mm = max(worst_mm, 1e3 * off_m, 1e3 * aside_m)
            self.assertLess(max(off_m, aside_m), 0.01, f"frame {number}")
        print(f"{len(estimated)} of {len(frames)} frames estimated, at most {worst_mm:.1f} mm off in the mean")

    def test_commands_for_a_camera_are_among_those_that_are_typed_for_files(self):
        page = (ROOT / PAGE).read_text(encoding="utf-8")
        typed = "".join(BLOCK.findall(page))
        shown = re.findall(r"^    weft (template make|\w+)", page, re.MULTILINE)
        self.assertGreaterEqual(len(shown), 4)
        for command in shown:
            self.assertIn(f"weft {command} ", typed)


if __name__ == "__main__":
    BUILD, ROOT = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    unittest.main(argv=sys.argv[:1])

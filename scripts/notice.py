#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes NOTICE from what was built, or checks it: notice.py [--write] BUILD

Which library is used where follows from what the programs and plugins link (readelf) and which headers
their objects were compiled from (Ninja's record of dependencies), so that header-only libraries count.
The licence of each component is that of its manifest.

Without --write prints one line for each mistake and exits 1 if there is one: a NOTICE that differs, a
library that LIBRARIES does not have, a component whose licence is not that of what it uses, a component
of the default pipeline that is not Apache-2.0. Exits 2 on wrong usage.
"""

import re
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
OWN = "Apache-2.0"
DEFAULT = "pipelines/demo.yaml"
PROGRAM = "the program"
CALIBRATE = "weft calibrate"


class Library(NamedTuple):
    name: str
    licence: str
    headers: str  # regular expression, from the include folder on
    shared: str = "$^"  # regular expression of the names of shared libraries


LIBRARIES = (
    Library("Boost 1.74", "BSL-1.0", r"boost/", r"libboost_"),
    Library("Ceres 2.1", "BSD-3-Clause", r"ceres/", r"libceres"),
    Library("CGAL 5.5", "GPL-3.0-or-later", r"CGAL/"),
    Library("CLI11", "BSD-3-Clause", r"CLI/"),
    Library("Eigen 3.4", "MPL-2.0", r"eigen3/"),
    Library("Embree 3", "Apache-2.0", r"embree3/", r"libembree3"),
    Library("FFmpeg 5.1", "LGPL-2.1-or-later", r"libav(codec|format|util)/", r"libav(codec|format|util)"),
    Library("fmt", "MIT", r"fmt/", r"libfmt"),
    Library("gflags, glog", "BSD-3-Clause", r"gflags/|glog/"),
    Library("GMP", "LGPL-3.0-or-later", r"gmp(xx)?\.h", r"libgmp"),
    Library("Highway 1.0", "Apache-2.0", r"hwy/", r"libhwy"),
    Library("libjpeg-turbo 2.1", "IJG, BSD-3-Clause", r"j(peglib|error|morecfg|config)\.h", r"libjpeg"),
    Library("libpng 1.6", "libpng", r"png\.h|pngconf\.h|pnglibconf\.h", r"libpng"),
    Library("libzip", "BSD-3-Clause", r"zip(conf)?\.h", r"libzip"),
    Library("minizip, zlib", "Zlib", r"minizip/|zlib\.h|zconf\.h", r"libminizip|libz\."),
    Library("MPFR", "LGPL-3.0-or-later", r"mpfr\.h", r"libmpfr"),
    Library("nlohmann-json", "MIT", r"nlohmann/"),
    Library("OpenCL headers, ICD loader", "Apache-2.0, BSD-2-Clause", r"CL/", r"libOpenCL"),
    Library("OpenCV 4.6", "Apache-2.0", r"opencv4/", r"libopencv_"),
    Library("Python 3.11", "PSF-2.0", r"python3\.11/", r"libpython3"),
    Library("SQLite 3", "public domain", r"sqlite3\.h", r"libsqlite3"),
    Library("tinygltf 2.7", "MIT", r"tiny_gltf\.h"),
    Library("xxHash", "BSD-2-Clause", r"xxhash\.h|xxh3\.h", r"libxxhash"),
    Library("yaml-cpp 0.7", "MIT", r"yaml-cpp/", r"libyaml-cpp"),
)
# The compiler's own, and the system's.
RUNTIME = re.compile(r"(libstdc\+\+|libm|libgcc_s|libc|libdl|libpthread|ld-linux.*|lib[a-z]*san)\.so")
SYSTEM_PACKAGES = re.compile(r"(libc6|linux-libc|libstdc\+\+-\d+|libgcc-\d+|libclang-.*|gcc-.*)(-dev)?$")

BEFORE = """\
Weft
Copyright the Weft contributors

This product is licensed under the Apache License, Version 2.0 (see LICENSE).

The lists of this file are written by scripts/notice.py from the manifests of the plugins, what they
link and which headers they include; a test checks them.


Licences of the components
--------------------------
"""
AFTER = """
Debian builds OpenCV with libraries under the GPL: a process that loads its module imgcodecs loads
Poppler and x265 (by GDAL), one that loads videoio also x264 and Xvid (by FFmpeg). Weft calls none of
them itself, except that sinks/overlay selects x264 for an .mp4 where FFmpeg has it. None is loaded
if OpenCV is built without GDAL, and FFmpeg without x264 and Xvid. Whoever passes on
binaries together with such packages has to keep to their licences.
Debian builds Ceres with SuiteSparse, parts of which (of CHOLMOD, SPQR) are under the GPL: a process
that loads solvers/brunet_refine loads them. Weft asks Ceres for Eigen's solver instead; a Ceres that
is built without SuiteSparse loads none. The same holds for whoever passes these on.

Plugins in Python, of which none is installed with Weft, link libpython (PSF-2.0) and load NumPy
(BSD-3-Clause). The package for programs in Python contains pybind11 (BSD-3-Clause), is loaded by
Python and loads NumPy; it draws by matplotlib (PSF-2.0, by its own wording).

Tests, which are not installed, also use GoogleTest (BSD-3-Clause) and Google Benchmark
(Apache-2.0); that of filters/myneighbor compares with CGAL. OpenCL devices have drivers of their
own, such as pocl (MIT).


Libraries inside the pages of `weft report`, and inside the live page
---------------------------------------------------------------------
A page with figures contains them as one script that npm builds from the packages that
framework/web/package-lock.json fixes. Their full list and texts stand at the end of each such page.

  Vega 6, Vega-Lite 6 (BSD-3-Clause): figures of reports
  D3, modules (ISC, BSD-3-Clause): figures of reports, by Vega
  three.js 0.187 (MIT): 3D view of both
"""


class Built(NamedTuple):
    """What was built; a room is a program, a plugin's library or a folder of shared code."""

    licences: dict[str, dict[str, str]]  # component -> licence, of each plugin's library
    headers: dict[str, set[str]]  # absolute paths, of each room
    shared: dict[str, set[str]]  # names of shared libraries, of each room


def output_of(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def room_of(made: str) -> str | None:
    """The room of an object file, None for tests and tools."""
    target = re.match(r"(framework(?:/cli)?|plugins/(\w+)/(\w+))/CMakeFiles/([^/]+)\.dir/", made)
    if not target:
        return None
    place, role, name, program = target.groups()
    if program.endswith("_test") or program.startswith("weft_test"):
        return None
    if role is None:
        return CALIBRATE if program in ("weft_calibrate", "weft_calibration") else PROGRAM
    if "common" in (role, name):
        return f"plugins/{role}/{name}"
    return f"{role}_{name}" if program.endswith("_objects") else None


def collect(build: Path) -> Built:
    built = Built({}, {}, {})
    room = None
    for line in output_of("ninja", "-C", str(build), "-t", "deps").splitlines():
        if not line.startswith(" "):
            room = room_of(line.split(":")[0])
        elif room is not None and line.strip().startswith("/usr/"):
            built.headers.setdefault(room, set()).add(line.strip())
    libraries = {PROGRAM: [build / "bin/weft", build / "bin/weft-worker"],
                 CALIBRATE: [build / "bin/weft-calibrate"]}
    for manifest in sorted((build / "lib/weft/plugins").glob("*.plugin.yaml")):
        plugin = manifest.name.removesuffix(".plugin.yaml")
        libraries[plugin] = [manifest.with_name(plugin + ".so")]
        ids = re.findall(r'^  - id: "(.*)"$', manifest.read_text(encoding="utf-8"), re.M)
        licences = re.findall(r'^    licence: "(.*)"$', manifest.read_text(encoding="utf-8"), re.M)
        built.licences[plugin] = dict(zip(ids, licences, strict=True))
    for room, files in libraries.items():
        needed = (output_of("readelf", "-d", "-W", str(file)) for file in files)
        built.shared[room] = set(re.findall(r"\(NEEDED\).*\[(.+)\]", "".join(needed)))
    return built


def from_include_folder(header: str) -> str:
    return re.sub(r"^/usr/(local/)?include/([^/]*-linux-gnu/)?", "", header)


def uses_of(built: Built) -> dict[str, set[Library]]:
    uses = {}
    for room in sorted(set(built.headers) | set(built.shared)):
        headers = {from_include_folder(header) for header in built.headers.get(room, ())}
        uses[room] = {
            library for library in LIBRARIES
            if any(re.match(library.headers, header) for header in headers)
            or any(re.match(library.shared, name) for name in built.shared.get(room, ()))}
    return uses


def packages_of(headers: set[str]) -> dict[str, str]:
    """The Debian package of each header; empty where there is no dpkg."""
    try:
        found = subprocess.run(["dpkg-query", "-S", *sorted(headers)], capture_output=True, text=True)
    except FileNotFoundError:
        return {}
    pairs = (line.rsplit(": ", 1) for line in found.stdout.splitlines() if ": " in line)
    return {path: packages.split(",")[0].split(":")[0] for packages, path in pairs}


def unknown_libraries(built: Built):
    """What LIBRARIES does not have."""
    for room, names in sorted(built.shared.items()):
        for name in sorted(names):
            if not RUNTIME.match(name) and not any(re.match(l.shared, name) for l in LIBRARIES):
                yield f"{room} links {name}: add it to LIBRARIES of scripts/notice.py"
    rest = {header: room for room, headers in sorted(built.headers.items()) for header in headers
            if not any(re.match(l.headers, from_include_folder(header)) for l in LIBRARIES)}
    strangers = {(rest[header], package) for header, package in packages_of(set(rest)).items()
                 if header in rest and not SYSTEM_PACKAGES.match(package)}
    for room, package in sorted(strangers):
        yield f"{room} includes headers of {package}: add it to LIBRARIES of scripts/notice.py"


def is_copyleft(licence: str) -> bool:
    return licence.startswith("GPL")


def wrong_licences(built: Built):
    for room, libraries in uses_of(built).items():
        strict = sorted(l.name for l in libraries if is_copyleft(l.licence))
        if room not in built.licences:
            if strict:
                yield f"{room} uses {', '.join(strict)}, under the GPL: keep that in a plugin"
            continue
        for component, licence in built.licences[room].items():
            if strict and not is_copyleft(licence):
                yield (f"{component} uses {', '.join(strict)}, under the GPL, and its manifest says "
                       f"{licence}: say .licence in its kAbout")
            if not strict and is_copyleft(licence):
                yield f"{component} says {licence} but uses nothing under the GPL"


def wrong_defaults(built: Built, pipeline: str):
    licences = {id: licence for each in built.licences.values() for id, licence in each.items()}
    for component in re.findall(r"\buse: ([\w./]+)", pipeline):
        licence = licences.get(component, "no licence, as it is not built")
        if licence != OWN:
            yield f"{component}, of {DEFAULT}, has {licence}: the default pipeline is {OWN}"


def paragraph(text: str, indent: str = "") -> str:
    return textwrap.fill(text, 100, initial_indent=indent, subsequent_indent=indent,
                         break_long_words=False, break_on_hyphens=False) + "\n"


def licences_text(built: Built) -> str:
    licences = {id: licence for each in built.licences.values() for id, licence in each.items()}
    others = {}
    for component, licence in sorted(licences.items()):
        if licence != OWN:
            others.setdefault(licence, []).append(component)
    text = paragraph(f"The program, the SDK and all components but those below are {OWN}, and so is "
                     f"the default pipeline, {DEFAULT}.")
    for licence, components in sorted(others.items()):
        text += "\n" + paragraph(f"{licence}: {', '.join(components)}", "  ")
    strict = [id for licence, ids in sorted(others.items()) if is_copyleft(licence) for id in ids]
    if strict:
        text += "\n" + paragraph(
            f"The sources of {' and '.join(strict)} are {OWN}. They include packages of CGAL under the "
            "GPL: their binaries, and a process that loads one of them, form a combined work that may "
            "be distributed under GPL-3.0-or-later only. A pipeline without them is not. `weft "
            "plugins list` shows the licence of each component.")
    return text


def libraries_text(built: Built) -> str:
    uses = uses_of(built)
    plugins = sorted(built.licences)
    text = ("\n\nLibraries that Weft includes or links\n-------------------------------------\n" + paragraph(
        "None of them is part of this repository; they are installed as packages of the system."))
    for library in LIBRARIES:
        users = [plugin for plugin in plugins if library in uses[plugin]]
        names = [", ".join(built.licences[plugin]) for plugin in users]
        if users == plugins:
            names = ["all components"]
        names[:0] = [program for program in (PROGRAM, CALIBRATE) if library in uses.get(program, ())]
        if names:
            text += f"\n  {library.name} ({library.licence})\n" + paragraph(", ".join(names), "    ")
    return text


def notice(built: Built) -> str:
    return BEFORE + licences_text(built) + libraries_text(built) + AFTER


def not_built(build: Path):
    for folder in sorted((ROOT / "plugins").glob("*/*/CMakeLists.txt")):
        role, name = folder.parts[-3:-1]
        plugin = build / f"lib/weft/plugins/{role}_{name}.plugin.yaml"
        if "common" not in (role, name) and not plugin.exists():
            yield f"{role}/{name} is not built: build all plugins first"


def main(arguments: list[str]) -> int:
    write = arguments[:1] == ["--write"]
    arguments = arguments[1:] if write else arguments
    if len(arguments) != 1 or not (Path(arguments[0]) / "build.ninja").is_file():
        print("usage: notice.py [--write] BUILD, a folder that Ninja builds in", file=sys.stderr)
        return 2
    build = Path(arguments[0])
    mistakes = list(not_built(build))
    if not mistakes:
        built = collect(build)
        pipeline = (ROOT / DEFAULT).read_text(encoding="utf-8")
        mistakes = [*unknown_libraries(built), *wrong_licences(built), *wrong_defaults(built, pipeline)]
        if write and not mistakes:
            (ROOT / "NOTICE").write_text(notice(built), encoding="utf-8")
        elif (ROOT / "NOTICE").read_text(encoding="utf-8") != notice(built):
            mistakes.append("NOTICE differs from what was built: cmake --build BUILD --target notice")
    print("\n".join(mistakes) if mistakes else "NOTICE says what was built")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

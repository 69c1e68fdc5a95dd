#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that each plugin exports `weft_library` alone and needs no library of the host, and that
neither plugins nor the objects of the program read the clock of the day, which may jump. The
linked program contains libraries of others, which may.

Usage: exported_symbols.py BUILD_PLUGIN_DIR [ARCHIVE_OR_OBJECT ...]

Prints one line `file: rule` for each violation; exits 1 if there is one, 2 on wrong usage.
"""

import re
import subprocess
import sys
from pathlib import Path

SYMBOL = "weft_library"
# `clock_gettime` is not among them: it reads steady clocks and those of processors, too.
CLOCK_OF_THE_DAY = {"time", "gettimeofday", "ftime", "timespec_get",
                    "_ZNSt6chrono3_V212system_clock3nowEv"}


def output_of(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def exported_symbols(library: Path) -> list[str]:
    lines = output_of("nm", "-D", "--defined-only", "--format=posix", str(library)).splitlines()
    return sorted(line.split()[0] for line in lines)


def needed_libraries(library: Path) -> list[str]:
    return re.findall(r"\(NEEDED\).*\[(.+)\]", output_of("readelf", "-d", "-W", str(library)))


def looks_at_the_day(file: Path) -> list[str]:
    dynamic = [] if file.suffix in (".a", ".o") else ["-D"]
    lines = output_of("nm", *dynamic, "--undefined-only", "--format=posix", str(file)).splitlines()
    called = CLOCK_OF_THE_DAY & {line.split()[0].split("@")[0] for line in lines if line}
    return [f"calls {name}, and the clock of the day may jump; take a steady one"
            for name in sorted(called)]


def violations_of(library: Path) -> list[str]:
    found = looks_at_the_day(library)
    symbols = exported_symbols(library)
    if SYMBOL not in symbols:
        found.append(f"does not export {SYMBOL}; end the plugin with WEFT_PLUGIN(...)")
    others = [symbol for symbol in symbols if symbol != SYMBOL]
    if others:
        shown = ", ".join(others[:5]) + (", ..." if len(others) > 5 else "")
        found.append(f"exports {len(others)} more symbols ({shown}); link it by weft_add_plugin()")
    for needed in needed_libraries(library):
        if needed.startswith("libweft"):
            found.append(f"needs {needed}, a library of the host; link weft::sdk only")
    return found


def main(arguments: list[str]) -> int:
    libraries = sorted(Path(arguments[0]).glob("*.so")) if arguments else []
    if not libraries:
        print("usage: exported_symbols.py FOLDER [ARCHIVE_OR_OBJECT ...]; the folder holds plugins (*.so)", file=sys.stderr)
        return 2
    violations = [f"{library}: {rule}" for library in libraries for rule in violations_of(library)]
    violations += [f"{own}: {rule}" for own in map(Path, arguments[1:])
                   for rule in looks_at_the_day(own)]
    for violation in violations:
        print(violation)
    print(f"{len(violations)} violations in {len(libraries)} plugins")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

# SPDX-License-Identifier: Apache-2.0
"""The program and the schemas that it prints."""

import json
import os
import subprocess

from jsonschema import Draft202012Validator


class Program:
    def __init__(self, weft, plugins):
        self.weft = weft
        self.environment = os.environ | {"WEFT_PLUGIN_PATH": str(plugins)}

    def run(self, *arguments):
        return subprocess.run([self.weft, *arguments], env=self.environment, text=True,
                              capture_output=True, check=False)

    def printed(self, *arguments):
        done = self.run(*arguments)
        if done.returncode != 0:
            raise AssertionError(f"{arguments}: {done.stderr}")
        return done.stdout

    def json(self, *arguments):
        return json.loads(self.printed(*arguments))

    def schema(self, kind):
        return self.json("schema", kind)

    def accepted(self, files):
        """Those of the files that `weft check` accepts."""
        said = self.run("check", *files).stdout.splitlines()
        return {line.split(": ok, ")[0] for line in said if ": ok, " in line}


def mistakes(schema, document):
    """What a schema says of a document: `stages.3.use: ...`."""
    return [f"{'.'.join(map(str, error.absolute_path))}: {error.message[:200]}"
            for error in Draft202012Validator(schema).iter_errors(document)]

# SPDX-License-Identifier: Apache-2.0
"""The one exception of the library."""


class Error(Exception):
    """What is wrong, where, and what to change.

    `message` is a sentence, `where` the place of the mistake (`pipeline.yaml:9:15`, a stage, a file), empty
    where there is none. `code` is one of `no_result`, `invalid_value`, `invalid_data`, `not_found`, `io`,
    `syntax`, `incompatible`, `unsupported`, `plugin_failure`, `cancelled`, `no_memory` and `end`.
    """

    __module__ = "weft"  # where it is met

    def __init__(self, message: str, where: str = "", code: str = "invalid_data") -> None:
        super().__init__(message, where, code)
        self.message, self.where, self.code = message, where, code

    def __str__(self) -> str:
        return f"{self.where}: {self.message}" if self.where else self.message

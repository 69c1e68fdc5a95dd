# SPDX-License-Identifier: Apache-2.0
"""Damaged libraries, and manifests that do not fit their library."""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Callable

from trials import ALL_GOOD, ID, LIBRARY, MANIFEST, Case, Ask, Sandbox

AGAIN = "build or install the plugin again"
DESCRIBE = "run: weft plugins describe"


def patched(offset: int, code: str, value: int) -> Callable[[Sandbox], None]:
    """Another value in the ELF header."""

    def make(sandbox: Sandbox) -> None:
        content = bytearray(sandbox.library.read_bytes())
        struct.pack_into(code, content, offset, value)
        sandbox.library.write_bytes(content)

    return make


def cut(length: Callable[[int], int]) -> Callable[[Sandbox], None]:
    def make(sandbox: Sandbox) -> None:
        content = sandbox.library.read_bytes()
        sandbox.library.write_bytes(content[:length(len(content))])

    return make


def without_sections(sandbox: Sandbox) -> None:
    patched(40, "<Q", 0)(sandbox)
    for offset in (60, 62):
        patched(offset, "<H", 0)(sandbox)


def with_manifest(text: str) -> Callable[[Sandbox], None]:
    return lambda sandbox: sandbox.write_manifest(text)


def edited(before: str, after: str) -> Callable[[Sandbox], None]:
    return lambda sandbox: sandbox.edit_manifest(before, after)


def of_another(sandbox: Sandbox) -> None:
    sandbox.replace_library("filters_test_function.so")
    (sandbox.folder / LIBRARY).write_bytes((sandbox.libraries.faulty / LIBRARY).read_bytes())


def without_manifest(sandbox: Sandbox) -> None:
    sandbox.manifest.unlink()


def with_a_twin(sandbox: Sandbox) -> None:
    (sandbox.folder / "twin.so").write_bytes(sandbox.library.read_bytes())
    (sandbox.folder / "twin.plugin.yaml").write_text(sandbox.libraries.manifest)


def as_folder(name: str) -> Callable[[Sandbox], None]:
    def make(sandbox: Sandbox) -> None:
        (sandbox.folder / name).unlink()
        (sandbox.folder / name).mkdir()

    return make


def as_dangling_link(sandbox: Sandbox) -> None:
    sandbox.library.unlink()
    sandbox.library.symlink_to("nowhere.so")


def as_loop_of_links(sandbox: Sandbox) -> None:
    sandbox.library.unlink()
    sandbox.library.symlink_to(LIBRARY)


def as_pipe(sandbox: Sandbox) -> None:
    sandbox.manifest.unlink()
    os.mkfifo(sandbox.manifest)


def component_twice(sandbox: Sandbox) -> None:
    text = sandbox.libraries.manifest
    at = text.index("  - id:")
    sandbox.write_manifest(text + text[at:])


def with_unknown_keys(sandbox: Sandbox) -> None:
    text = sandbox.libraries.manifest + "    a_later_key: [1, {two: 3}]\n"
    sandbox.write_manifest(text.replace("weft_plugin: 1\n", "weft_plugin: 1\nanother: {of: them}\n"))


def refused(name: str, make: Callable[[Sandbox], None], cause: str, fix: str) -> Case:
    """Found unusable before it is loaded: all commands say so, with cause and fix."""
    both = f"{cause}.*{re.escape(fix)}"
    asks = [Ask("list", both), Ask("doctor", both), Ask("why", both, 2), Ask("check", both, 2),
            Ask("run", both, 2)]
    # The well-behaved ones of the other folder are still there.
    asks[0].says = f"filters/test.scripted .*{both}"
    return Case(name, asks, make)


def accepted(name: str, make: Callable[[Sandbox], None]) -> Case:
    return Case(name, [Ask("list", f"{ID} .*", verdict="accepted", never="refused "),
                         Ask("why", "can be used", verdict="accepted"),
                         Ask("run", "4 frames, 0 failed", frames=ALL_GOOD, verdict="accepted")],
                  make)


def misshapen(name: str, cause: str) -> Case:
    """One whose manifest promises what the library, once it is loaded, does not have."""

    def make(sandbox: Sandbox) -> None:
        sandbox.replace_library(f"filters_test_{name}.so")

    return Case(f"symbol_{name}", [
        Ask("list", f"{ID} ", verdict="listed: only its manifest is read"),
        Ask("why", cause, 2), Ask("describe", cause, 3), Ask("run", cause, 2),
        Ask("isolated", cause, 2)], make)


ALIASES = "a: &a [" + ", ".join(["x"] * 9) + "]\n" + "".join(
    f"{b}: &{b} [" + ", ".join([f"*{a}"] * 9) + "]\n" for a, b in zip("abcdefgh", "bcdefghi"))

OF_FILES = [
    refused("truncated", cut(lambda size: size // 2), "truncated ELF file", AGAIN),
    refused("empty", cut(lambda size: 0), "is no 64-bit ELF file", AGAIN),
    refused("text", lambda sandbox: sandbox.library.write_text("#!/bin/sh\n" * 50),
            "is no 64-bit ELF file", AGAIN),
    refused("foreign_processor", patched(18, "<H", 183), "another processor than x86-64", AGAIN),
    refused("of_32_bits", patched(4, "B", 1), "is no 64-bit ELF file", AGAIN),
    refused("big_endian", patched(5, "B", 2), "another processor than x86-64", AGAIN),
    refused("executable", patched(16, "<H", 2), "it is no shared library", AGAIN),
    refused("segments_elsewhere", patched(32, "<Q", 1 << 40), "truncated ELF file", AGAIN),
    accepted("without_sections", without_sections),
    refused("without_build_id", lambda sandbox: sandbox.replace_library("filters_test_anonymous.so"),
            "it has no build-id", "link it with -Wl,--build-id=sha1"),
    refused("library_is_folder", as_folder(LIBRARY), "is no regular file", AGAIN),
    refused("dangling_link", as_dangling_link, "the library is missing", AGAIN),
    refused("loop_of_links", as_loop_of_links, "Too many levels of symbolic links", AGAIN),
    refused("manifest_of_another", of_another, "belongs to another build of it", DESCRIBE),
    refused("without_manifest", without_manifest, "it has no manifest beside it", DESCRIBE),
    refused("manifest_is_folder", as_folder(MANIFEST), "its manifest cannot be read", DESCRIBE),
    refused("manifest_is_pipe", as_pipe, "its manifest cannot be read", DESCRIBE),
    refused("manifest_empty", with_manifest(""), "its manifest cannot be read", DESCRIBE),
    refused("manifest_broken", with_manifest("weft_plugin: [1\nabi:"),
            "its manifest cannot be read", DESCRIBE),
    refused("manifest_binary", with_manifest("weft_plugin: 1\0\x01\x02"),
            "its manifest cannot be read", DESCRIBE),
    refused("manifest_bomb", with_manifest(ALIASES), "its manifest cannot be read", DESCRIBE),
    refused("manifest_deep", with_manifest("weft_plugin: " + "[" * 5000 + "]" * 5000),
            "its manifest cannot be read", DESCRIBE),
    refused("manifest_large", with_manifest("weft_plugin: 1\nabi: " + "x" * (80 << 20)),
            "its manifest cannot be read", DESCRIBE),
    refused("manifest_2", edited("weft_plugin: 1", "weft_plugin: 2"),
            "has another manifest version", DESCRIBE),
    accepted("manifest_unknown_keys", with_unknown_keys),
    refused("no_components", edited("components:", "components: []\nothers:"),
            "'components' is empty", DESCRIBE),
    refused("id_twice", component_twice, f"'{ID}' is in it twice", "correct the id"),
    refused("id_in_two_libraries", with_a_twin, f"'{ID}' is also in .*twin.so",
            "keep one of the two"),
    Case("role_unknown", [
        Ask("list", "'clouds' of 'clouds/test_faulty' is no role.*install a newer Weft"),
        Ask("doctor", "'clouds' of 'clouds/test_faulty' is no role.*install a newer Weft"),
        Ask("check", f"no plugin '{ID}' is installed", 2)], edited(ID, "clouds/test_faulty")),
    refused("type_unknown", edited("type: f64", "type: tensor"), "has the unknown type 'tensor'",
            "install a newer Weft"),
    refused("processor_feature", edited("isa: []", "isa: [avx9]"),
            "processor features that this version of Weft does not know: avx9", "rebuild the plugin without"),
    refused("abi_major_2", edited("abi: [1,", "abi: [2,"), "has plugin ABI 2", "rebuild the plugin"),
    refused("abi_major_0", edited("abi: [1,", "abi: [0,"), "has plugin ABI 0", "rebuild the plugin"),
    refused("abi_minor_99", edited("needs_minor: 0", "needs_minor: 99"), "needs plugin ABI 1.99",
            "rebuild the plugin"),
    misshapen("function", "'weft_library' is no table of data; end a source file with"),
    misshapen("small", "'weft_library' is no table of data; end a source file with"),
    misshapen("zeroed", "is no Weft library table; rebuild it with"),
    misshapen("unresolved", "undefined symbol: .*nowhere_to_be_found.*install the library it needs"),
]

# SPDX-License-Identifier: Apache-2.0
"""Faults of loading, describing, creating, calling and destroying."""

from __future__ import annotations

import os

from trials import ALL_GOOD, ID, LIBRARY, ONE_LOST, Case, Ask, Sandbox

SWEEP = 'extensions: ["weft.sweep/1"]'  # extension of the library without a fault
TELLS = "Try isolate: process at its stage"
# Sanitizers make an exit code of a signal.
DIED = r"(died of signal {0} |exited with status)"
ENDED = r"ends the process that loads it (by signal {0} |by exit)"


def damaged(name: str, what: str) -> Case:
    """One with a damaged table: the sentence says where, and that it must be built anew."""
    says = f"{LIBRARY}: has a damaged library table: {what}; rebuild the plugin"
    why = f"has a damaged library table: {what}; rebuild the plugin"
    return Case(name, [Ask("describe", says, 3), Ask("why", why, 2), Ask("run", says, 2),
                         Ask("isolated", says, 2)])


def refused(name: str, says: str) -> Case:
    return Case(name, [Ask("describe", says, 3), Ask("why", says, 2), Ask("run", says, 2),
                         Ask("isolated", says, 2)])


def tolerated(name: str) -> Case:
    """What this version of the host may ignore."""
    return Case(name, [Ask("describe", "plugin.yaml", verdict="accepted"),
                         Ask("why", "can be used", verdict="accepted"),
                         Ask("run", "4 frames, 0 failed", frames=ALL_GOOD, verdict="accepted")])


def undescribed(name: str, says: str) -> Case:
    """Refused when its manifest is written, and so by the build."""
    return Case(name, [Ask("describe", says, 3)])


def ending_when_loaded(name: str, probed: str, here: str, in_worker: str, **more: object) -> Case:
    """Ends the process that loads it: others report it, that of a run reports what ran."""
    expected = rf"filters \({ID}: load\), outside of the frames: {here}.*{TELLS}"
    return Case(name, [
        Ask("describe", f"{probed}.*and rebuild it", 3),
        Ask("why", f"{probed}.*and rebuild it", 2),
        Ask("check", "ok, 6 stages", verdict="accepted: nothing is loaded"),
        Ask("run", expected, "fails", verdict="ended, told"),
        Ask("isolated", f"{ID}: its worker {in_worker}", 2, verdict="ended apart, told")], **more)


def calls(name: str, here: str, in_worker: str, **more: object) -> Case:
    """Ends its process in frame 1: told by the run, and one frame where it has its own process."""
    expected = rf"filters \({ID}: filter\), frame 1: {here}.*{TELLS}"
    return Case(name, [
        Ask("run", expected, "fails", verdict="ended, told"),
        Ask("isolated", f"frame 1 .*{ID}: its worker {in_worker}", 1, ONE_LOST, "one frame lost")],
        **more)


def fails(name: str, says: str) -> Case:
    """Answers a call with an error, or what is one: it costs that frame."""
    expected = f"first error of filters: frame 1 .*{ID}: {says}"
    return Case(name, [Ask("run", expected, 1, ONE_LOST, "one frame lost"),
                         Ask("isolated", expected, 1, ONE_LOST, "one frame lost")])


def restored(fault: str, part: str, when: str = "in a call") -> Case:
    """Changes what all components share: told, and restored, so that the run is not disturbed."""
    says = rf"filters: the process state changed {when}: {part} \((restored|cannot be restored)\)"
    return Case(fault, [Ask(command, says, 0, ALL_GOOD, "restored, told")
                        for command in ("run", "isolated")])


def contained(fault: str, **more: object) -> Case:
    """Disturbs neither the frames nor the end of the program."""
    return Case(fault, [Ask(command, "4 frames, 0 failed", 0, ALL_GOOD, "goes on")
                        for command in ("run", "isolated")], **more)


def with_check(sandbox: Sandbox) -> None:
    sandbox.edit_manifest(SWEEP, SWEEP.replace("]", ', "weft.check/1"]'))


def with_devices(sandbox: Sandbox) -> None:
    sandbox.edit_manifest(SWEEP, SWEEP.replace("]", ', "weft.devices/1"]'))


OF_TABLES = [
    refused("major_0", "has plugin ABI 0, this host has 1.*rebuild the plugin"),
    refused("major_2", "has plugin ABI 2, this host has 1.*rebuild the plugin"),
    refused("needs_minor", "needs plugin ABI 1.99, this host has 1.*rebuild the plugin"),
    damaged("count_0", "its count of components is 0"),
    damaged("count_huge", "its count of components is 4294967295"),
    damaged("null_components", "its components, isa or compiler is null"),
    damaged("null_component", "component 0: it is null"),
    damaged("null_isa", "its components, isa or compiler is null"),
    damaged("table_size_0", "its struct_size is too small"),
    damaged("table_small", "its struct_size is too small"),
    tolerated("table_larger"),
    damaged("reserved_used", "a reserved field is not zero"),
    tolerated("reserved_newer"),
    damaged("component_size_0", "component 0: its struct_size is too small"),
    damaged("component_small", "component 0: its struct_size is too small"),
    tolerated("component_larger"),
    tolerated("flag_low"),
    damaged("null_id", "component 0: one of its texts is null"),
    damaged("null_text", "component 0: one of its texts is null"),
    damaged("null_describe", "component 0: one of its functions is null"),
    damaged("null_create", "component 0: one of its functions is null"),
    damaged("null_prepare", "component 0: one of its functions is null"),
    damaged("null_process", "component 0: one of its functions is null"),
    damaged("null_destroy", "component 0: one of its functions is null"),
    *[Case(name, [Ask("why", "requires a feature that this version of Weft lacks; install a newer", 2),
                    Ask("run", "requires a feature that this version of Weft lacks; install a newer", 2)])
      for name in ("flag_high", "library_flag_high")],
    Case("illegal_id", [
        Ask("describe", "its id 'Filters Case' is not of the form role/name", 3),
        Ask("run", f"does not contain '{ID}'; rebuild it", 2)]),
    Case("endless_id", [
        Ask("describe", ENDED.format(11), 3),
        Ask("run", rf"\({ID}: load\), outside of the frames: ended the process \(SIGSEGV", "fails",
            verdict="ended, told"),
        Ask("isolated", "its worker " + DIED.format(11), 2, verdict="ended apart, told")]),
    Case("other_role", [
        Ask("describe", "plugin.yaml", verdict="accepted: a later version may know the role"),
        Ask("list", "'clouds' of 'clouds/test_faulty' is no role.*install a newer Weft"),
        Ask("check", f"no plugin '{ID}' is installed", 2)]),
    Case("no_methods", [
        Ask("run", f"{ID}: does not offer the method 'filter'", 1, "none none none none",
            "every frame lost")]),
    undescribed("twice", f"{ID}: is in the library twice"),
    undescribed("wrong_needs", "needs names 'curtains', which is no input of filters; there are"),
]

OF_LOADING = [
    ending_when_loaded("load_throws", ENDED.format(6), r"ended the process \(SIGABRT",
                       DIED.format(6)),
    ending_when_loaded("load_crashes", ENDED.format(11), r"ended the process \(SIGSEGV",
                       DIED.format(11)),
    ending_when_loaded("load_exits", r"ends the process that loads it by exit\(\d+\)",
                       r"called exit\(\)", "exited with status 0"),
    ending_when_loaded("load_eats", ENDED.format(6), r"ended the process \(SIGABRT",
                       DIED.format(6), limit_bytes=1 << 30, sanitized=False),
    Case("load_hangs", [
        Ask("describe", "does not come to an end within 20 s; .*and rebuild it", 3),
        Ask("why", "does not come to an end within 20 s; .*and rebuild it", 2),
        Ask("isolated", f"{ID}: its worker gave no answer within 10000 ms and was ended", 2,
            verdict="ended apart, told")]),
    tolerated("load_prints"),
    tolerated("load_locale"),
    tolerated("load_rounds"),
    tolerated("load_flushes"),
    Case("devices_crash", [
        Ask("devices", f"for {ID}: it {ENDED.format(11)}.*rebuild it", (0, 1))],
        with_devices),
]

OF_DECLARATIONS = [
    undescribed("describe_fails", r"failed while it declared its parameters \(no mood for it\)"),
    undescribed("describe_status", r"failed while it declared its parameters \(status 77\)"),
    undescribed("describe_throws", "threw something that is no std::exception"),
    undescribed("describe_crashes", ENDED.format(11)),
    undescribed("describe_exits", r"ends the process that loads it by exit\(\d+\)"),
    undescribed("describe_hangs", "does not come to an end within 20 s"),
    undescribed("describe_endlessly_hangs", "does not come to an end within 20 s"),
    Case("many_parameters", [Ask("describe", "plugin.yaml", verdict="accepted")]),
    undescribed("too_many_parameters", "declares more than 10000 parameters"),
    undescribed("parameter_twice", "parameter 'strictness' is declared twice"),
    undescribed("parameter_size_0", "declared with a struct_size that is too small"),
    tolerated("parameter_larger"),
    undescribed("null_parameter", "a parameter is null"),
    undescribed("null_name", "a parameter has no name"),
    undescribed("null_help", "'strictness' has a unit, help, role or was that is null"),
    undescribed("null_unit", "'strictness' has a unit, help, role or was that is null"),
    undescribed("null_default", "'strictness' has a default that is null"),
    undescribed("null_default_text", "'colour' has a default that is null"),
    undescribed("no_default", "'strictness' has no default and is not required"),
    undescribed("nan_default", "'strictness' has a default that is not finite"),
    undescribed("outside_default", "'strictness' has a default outside its range"),
    undescribed("nan_range", "'strictness' has a range whose minimum is the larger end"),
    undescribed("no_choices", "'colour' has a default that is none of its choices"),
    undescribed("null_choices", "'colour' has choices that are null"),
    undescribed("null_choice", "'colour' has choices that are null"),
    undescribed("foreign_choice", "'colour' has a default that is none of its choices"),
    undescribed("latin_text", "'strictness' has a text that is no UTF-8"),
    tolerated("control_text"),
    undescribed("null_record", "a type of records is null"),
    Case("unknown_type", [
        Ask("describe", "plugin.yaml", verdict="accepted: a later version may know the type"),
        Ask("list", "'strictness' has the unknown type '77'.*install a newer Weft"),
        Ask("run", "'strictness' has the unknown type '77'.*install a newer Weft", 2)]),
    undescribed("extension_crashes", ENDED.format(11)),
    undescribed("empty_sweep", "its extension weft.sweep/1 is damaged"),
    undescribed("empty_memory", "its extension weft.device_memory/1 is damaged"),
    undescribed("empty_devices", "its extension weft.devices/1 is damaged"),
    Case("empty_check", [
        Ask("describe", "its extension weft.check/1 is damaged", 3),
        Ask("check", f"{ID}: its check is damaged; rebuild the plugin", 2),
        Ask("run", f"{ID}: its check is damaged; rebuild the plugin", 2)], with_check),
]

OF_CALLS = [
    *[Case(name, [Ask("run", f"{ID}: {says}", 2), Ask("isolated", f"{ID}: {says}", 2)])
      for name, says in (("create_null", "created nothing and gave no reason"),
                         ("create_status", "gave no reason for its status 77"),
                         ("create_throws", "threw something that is no std::exception"),
                         ("prepare_status", "gave no reason for its status -5"))],
    *[Case(name, [Ask("run", rf"\({ID}: {what}\), outside of the frames: {here}.*{TELLS}",
                        "fails", verdict="ended, told"),
                    Ask("isolated", f"{ID}: its worker {in_worker}", 2, verdict="ended apart, told")])
      for name, what, here, in_worker in (
          ("create_crashes", "load", r"ended the process \(SIGSEGV", DIED.format(11)),
          ("create_exits", "load", r"called exit\(\)", "exited with status 0"),
          ("prepare_crashes", "prepare", r"ended the process \(SIGSEGV", DIED.format(11)),
          ("prepare_exits", "prepare", r"called exit\(\)", "exited with status 0"))],
    *[Case(name, [Ask("run", rf"\({ID}: destroy\), outside of the frames: {here}", "fails",
                        ALL_GOOD, "ended, told"),
                    Ask("isolated", "4 frames, 0 failed", 0, ALL_GOOD,
                        "goes on: all frames were there")])
      for name, here in (("destroy_crashes", r"ended the process \(SIGSEGV"),
                         ("destroy_exits", r"called exit\(\)"))],
    Case("create_hangs", [
        Ask("isolated", f"{ID}: its worker gave no answer within 10000 ms and was ended", 2,
            verdict="ended apart, told")]),
    calls("segv", r"ended the process \(SIGSEGV", DIED.format(11)),
    Case("segv_in_thread", [
        Ask("run", r"filters_test_faulty\.so, in a thread that it started, after the call filters "
            rf"\({ID}: filter\), frame 1: ended the process \(SIGSEGV.*{TELLS}", "fails", verdict="ended, told"),
        Ask("isolated", f"frame 1 .*{ID}: its worker {DIED.format(11)}", 1, ONE_LOST,
            "one frame lost")]),
    calls("bus", r"ended the process \(SIGBUS", DIED.format(7)),
    calls("fpe", r"ended the process \(SIGFPE", DIED.format(8)),
    calls("ill", r"ended the process \(SIGILL", DIED.format(4)),
    calls("abort", r"ended the process \(SIGABRT", DIED.format(6)),
    calls("overflow", r"ended the process \(SIGSEGV", DIED.format(11)),
    calls("exit", r"called exit\(\)", "exited with status 0"),
    calls("_exit", r"called _exit\(\)", "exited with status 0"),
    calls("quick_exit", r"called quick_exit\(\)", "exited with status 0"),
    calls("own_handler", r"called _exit\(\)", "exited with status 0"),
    calls("pthread_exit", r"ended the process \(SIGABRT", DIED.format(6)),
    Case("kill", [
        Ask("run", "", -9, verdict="ended: nobody can tell of SIGKILL"),
        Ask("isolated", f"{ID}: its worker died of signal 9", 1, ONE_LOST, "one frame lost")]),
    Case("kernel_exit", [
        Ask("isolated", f"{ID}: its worker exited with status 0", 1, ONE_LOST, "one frame lost")]),
    Case("hang", [
        Ask("interrupted", rf"interrupted twice, ended at once; running: filters \({ID}: filter\), "
            "frame 1", 130, verdict="ended, told"),
        Ask("isolated", f"{ID}: its worker gave no answer within 1000 ms and was ended", 1,
            ONE_LOST, "one frame lost")]),
    fails("throw", "threw: the sky fell down"),
    fails("status", "gave no reason for its status -77"),
    fails("end", "gave no reason for its status 5"),
    fails("latin_error", r"caf\\xE9"),
    Case("close_files", [
        Ask("run", "cannot be written .Bad file descriptor", 3, verdict="ended, told"),
        Ask("isolated", f"{ID}: its worker ", 1, ONE_LOST, "one frame lost")]),
    Case("close_all", [
        Ask("run", "", "fails", verdict="ended: it closed stderr, too"),
        Ask("isolated", f"{ID}: its worker ", 1, ONE_LOST, "one frame lost")]),
    restored("limits_files", "resource limits"),
    restored("starts_timer", "timers"),
    *([restored("changes_affinity", "CPU affinity")] if len(os.sched_getaffinity(0)) > 1 else []),
    restored("changes_priority", "priority"),
    restored("changes_signal_handler", "signals"),
    restored("changes_signal_mask", "signals"),
    restored("changes_locale", "locale"),
    restored("changes_locale_of_streams", "locale"),
    restored("changes_folder", "working directory"),
    restored("clears_environment", "environment"),
    restored("changes_time_zone", "environment"),
    restored("changes_terminate", "terminate handler"),
    restored("changes_umask", "umask"),
    *[restored(f"changes_umask@{place}", "umask", f"while it was {what}")
      for place, what in (("load", "loaded"), ("create", "created"), ("prepare", "prepared"))],
    contained("changes_umask@destroy"),  # restored, after the last message of the run
    Case("returns_twice", [Ask(command, r"made a copy of the process with fork\(\)", 0, ALL_GOOD,
                               "ended, told") for command in ("run", "isolated")]),
    contained("crashes_at_exit", sanitized=False),
    contained("hangs_at_exit", sanitized=False),
    Case("prints", [Ask("isolated", "4 frames, 0 failed", 0, ALL_GOOD, "kept out of the output",
                        "nobody asked for")]),
    *[Case(name, [Ask(command, "left the floating-point mode changed; it was set back .4 of 4", 0,
                        ALL_GOOD, "set back, told") for command in ("run", "isolated")])
      for name in ("changes_rounding", "changes_precision", "flushes_denormals")],
]

# SPDX-License-Identifier: Apache-2.0
"""Connects the library and the components: a call by the host becomes a call of a method, and its
result or exception becomes the answer to the host. Each function answers (status, code, message, value).
"""

import functools
import traceback

import numpy as np
from weft.answers import Cancelled, Degenerate, Failure, NoMoreFrames, NoResult
from weft.given import (CANCELLED, DEGENERATE, END, ERROR, NO_RESULT, OK, ROLES, Given, HostError, Nested,
                        arrays_of, memory_for)
from weft.parameters import parameters_of
from weft.records import Record

# Values of weft::Errc.
CODE_NO_RESULT, CODE_INVALID_DATA, CODE_PLUGIN_FAILURE, CODE_CANCELLED, CODE_NO_MEMORY, CODE_END = (
    1, 3, 9, 10, 11, 12)
# Default values of outputs.
USUAL = {"shape": {"state": 1, "age": 0, "confidence": 1.0}, "image": {"stem": ""},
         "ground_truth": {"kind": "", "apart": ""}}
OF_PREPARE = {"template": "template/1", "camera": "camera/1"}

own_files = set()
modules = {}


def adopt(name, file, module):
    """Registers a module of the author, whose file errors name."""
    own_files.add(file)
    modules[name] = module


def place_of(thrown):
    """`, local_motion.py:12, in filter`: the innermost place in the author's files."""
    place = ""
    for frame, line in traceback.walk_tb(thrown.__traceback__):
        if frame.f_code.co_filename in own_files:
            place = f" ({frame.f_code.co_filename}:{line}, in {frame.f_code.co_name})"
    return place


def text_of(thrown):
    return " ".join(str(thrown).split()).replace("\0", "")


def reporting_errors(work):
    """Nothing that is raised leaves the function."""
    @functools.wraps(work)
    def asked(*arguments):
        try:
            return work(*arguments)
        except NoResult as reason:
            return NO_RESULT, CODE_NO_RESULT, text_of(reason) or "no reason is given", None
        except NoMoreFrames as reason:
            return END, CODE_END, text_of(reason) or "no reason is given", None
        except Cancelled:
            return CANCELLED, CODE_CANCELLED, "cancelled", None
        except Failure as failure:
            return ERROR, CODE_INVALID_DATA, text_of(failure) or "no cause is given", None
        except HostError as error:
            return ERROR, error.code, text_of(error), None
        except MemoryError:
            return ERROR, CODE_NO_MEMORY, "out of memory", None
        except BaseException as thrown:
            sentence = f"threw: {type(thrown).__name__}: {text_of(thrown)}{place_of(thrown)}"
            return ERROR, CODE_PLUGIN_FAILURE, sentence, None
    return asked


@reporting_errors
def create(module, class_name, values):
    component_class = getattr(modules[module], class_name)
    declared = parameters_of(component_class)
    given = {name: Nested(declared[name].role, value) if declared[name].kind == "component" else value
             for name, value in values.items()}
    return OK, 0, "", component_class(**given)


@reporting_errors
def check(component):
    return OK, 0, "", [(str(name), text_of(mistake)) for name, mistake in component.check() or ()]


@reporting_errors
def prepare(component, call, inputs):
    component.prepare(Given(component.role, call, OF_PREPARE, inputs))
    return OK, 0, "", None


@reporting_errors
def process(component, call, method, inputs):
    name, slots, outputs = ROLES[component.role][method]
    given = Given(component.role, call, slots, inputs)
    answer = getattr(component, name)(given)
    reason = ""
    if isinstance(answer, Degenerate):
        reason, answer = answer.reason or "no reason is given", answer.value
    for slot, record in records_of(name, outputs, answer).items():
        write(component, given.call, slot, outputs[slot], record)
    return (DEGENERATE, 0, reason, None) if reason else (OK, 0, "", None)


def records_of(method, outputs, answer):
    """The records of an answer, by output."""
    if not outputs:
        return {}
    if list(outputs) == ["count"] and isinstance(answer, int):
        answer = Record(frames=answer, live=0)
    legal = (Record, type(None))
    if len(outputs) == 1:
        answer, legal = {next(iter(outputs)): answer}, (Record,)
    if not isinstance(answer, dict) or not all(isinstance(each, legal) for each in answer.values()):
        wanted = "a Record" if len(outputs) == 1 else "a dict of Records"
        raise TypeError(f"{method}() must return {wanted}, or weft.degenerate() of it")
    for slot in answer:
        if slot not in outputs:
            raise TypeError(f"{method}() has no output '{slot}'; it may have: {', '.join(outputs)}")
    return {slot: record for slot, record in answer.items() if record is not None}


def write(component, call, slot, record_type, record):
    """Copies the arrays of a record into memory of the host, but those that are there already."""
    usual = {"producer": component.id} if slot == "warp" else USUAL.get(slot, {})
    for name, dtype, array in arrays_of(record_type, record, usual):
        if call.filled.get((slot, name)) is not array:
            np.asarray(memory_for(call.raw, slot, record_type, name, dtype, array.shape))[...] = array

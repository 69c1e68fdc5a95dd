# SPDX-License-Identifier: Apache-2.0
"""The inputs of a method: records of the host as views, its call, and other components."""

import numpy as np
from weft import host
from weft.answers import Cancelled, NoMoreFrames, NoResult
from weft.records import Record

CATALOGUE = host.catalogue()  # type -> array -> (dtype, axes, is text, is optional)
ROLES = host.roles()  # role -> list of (method, inputs: slot -> type, outputs: slot -> type)
DTYPES = {1: np.uint8, 2: np.int8, 3: np.uint16, 4: np.int16, 5: np.int32, 6: np.int64, 7: np.float32,
          8: np.float64, 9: np.float16, 10: np.uint32, 11: np.uint64}
CODES = {np.dtype(kind): code for code, kind in DTYPES.items()}
SEVERAL = {("matchers", "correspondences")}  # inputs that take several records
OK, DEGENERATE, NO_RESULT, ERROR, CANCELLED, END = range(6)


class HostError(Exception):
    """An error of the host or of another component."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


class GivenRecord(Record):
    """A record of the host; its arrays become views at the first access."""

    def __init__(self, record):
        super().__init__()
        self._type, self._revision, self._producer, self._origin, arrays = record
        self._memories = dict(arrays)
        self._views = {}  # as they were handed out
        for name in self._memories:
            for prefix, named in (("diag.", self.diag), ("model.", self.model)):
                if name.startswith(prefix):
                    named[name.removeprefix(prefix)] = self._views[name] = self._value(name)

    def _is_as_read(self):
        """True if no array was replaced, added or removed."""
        now = {name: value for name, value in vars(self).items()
               if not name.startswith("_") and name not in ("diag", "model", "degenerate_reason")}
        for prefix, named in (("diag.", self.diag), ("model.", self.model)):
            now.update((prefix + name, value) for name, value in named.items())
        return now.keys() == self._views.keys() and all(now[name] is value
                                                        for name, value in self._views.items())

    @property
    def revision(self):
        """Equal only for equal content; 0 is unknown."""
        return self._revision

    def _value(self, name):
        array = np.asarray(self._memories[name])
        if CATALOGUE.get(self._type, {}).get(name, (0, "", False, False))[2]:
            return array.tobytes().decode("utf-8", "replace")
        return array if array.ndim else array.item()

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._memories:
            value = self._value(name)
        elif name in CATALOGUE.get(self._type, {}):
            value = None  # optional, and absent
        else:
            known = ", ".join(CATALOGUE.get(self._type, {}))
            raise AttributeError(f"{self._type} has no array '{name}'; it has: {known}")
        self.__dict__[name] = self._views[name] = value
        return value


class Call:
    """The context of one call of a component; invalid after the call."""

    def __init__(self, raw):
        self.raw, self.filled = raw, {}
        self.frame, self.seed, self.threads = raw.frame, raw.seed, raw.threads

    def cancelled(self):
        return self.raw.cancelled()

    def go_on(self):
        """In long loops, at least every 5 ms: leaves the call where it is cancelled."""
        if self.raw.cancelled():
            raise Cancelled

    def log_info(self, text):
        self.raw.log(1, str(text))

    def log_warning(self, text):
        """Warns the user although the call has a result."""
        self.raw.log(2, str(text))

    def rng(self):
        """NumPy's generator, the same for this component in this frame wherever it runs."""
        return np.random.Generator(np.random.PCG64(self.seed))

    def output(self, slot, name, shape):
        """An array [shape] in the host's memory, to be filled and put into the record that is returned
        as output `slot` without a copy. It is not cleared."""
        record_type = f"{slot}/1"
        dtype = CATALOGUE[record_type][name][0]
        array = np.asarray(memory_for(self.raw, slot, record_type, name, dtype, shape))
        self.filled[slot, name] = array
        return array


class Given:
    """The inputs of a method as attributes, None where they are absent."""

    def __init__(self, role, raw, slots, inputs):
        self.call = Call(raw)
        for slot in slots:
            records = [GivenRecord(record) for name, record in inputs if name == slot]
            is_list = (role, slot) in SEVERAL
            value = records if is_list else records[0] if records else None
            setattr(self, slot.replace(".", "_"), value)


    def evaluate(self, warp, points_px, order=0):
        """Samples of a warp of any component at points_px [M,2] of the texture, with derivatives up
        to `order`, 0 to 2."""
        number = [name for name, _, _ in ROLES["warps"]].index("evaluate")
        _, inputs, outputs = ROLES["warps"][number]
        records = {"warp": warp, "points": Record(xy_px=points_px, order=order)}
        return ask(self, warp._producer, number, inputs, outputs, records)


class Nested:
    """A component that another one holds, by the methods of its role: `held.fit(given,
    correspondences=..., template=...)` answers as a method in Python does, with a Record or with a dict
    of Records. Inputs whose names have a dot are given with an underscore."""

    def __init__(self, role, handle):
        self.role, self.handle = role, handle

    def __getattr__(self, name):
        for number, (method, inputs, outputs) in enumerate(ROLES[self.role]):
            if method == name:
                return lambda given, **records: ask(given, self.handle, number, inputs, outputs, records)
        raise AttributeError(f"{self.role} have no method '{name}'")


def memory_for(raw_call, slot, record_type, name, dtype, shape):
    """Memory of the host for an array of an output."""
    memory = raw_call.alloc(slot, record_type, name, dtype, tuple(shape))
    if memory is None:
        raise HostError(9, f"the array '{name}' of {record_type} cannot be an output")
    return memory


def ask(given, handle, method, inputs, outputs, records):
    slots = {slot.replace(".", "_"): slot for slot in inputs}
    passed = []
    for name, record in records.items():
        if record is None:
            continue
        if name not in slots:
            raise TypeError(f"there is no input '{name}'; there are: {', '.join(slots)}")
        slot = slots[name]
        as_read = not isinstance(record, GivenRecord) or record._is_as_read()
        arrays = [(array_name, dtype, np.ascontiguousarray(array) if array.ndim else array)
                  for array_name, dtype, array in arrays_of(inputs[slot], record, {})]
        passed.append((slot, inputs[slot], getattr(record, "_revision", 0) if as_read else 0,
                       getattr(record, "_producer", 0), getattr(record, "_origin", b""), arrays))
    status, code, message, answer = given.call.raw.invoke(handle, method, passed)
    if status == NO_RESULT:
        raise NoResult(message)
    if status == END:
        raise NoMoreFrames(message)
    if status == CANCELLED:
        raise Cancelled
    if status not in (OK, DEGENERATE):
        raise HostError(code, message)
    found = {slot: GivenRecord(record) for slot, record in answer}
    for record in found.values():
        record.degenerate_reason = message if status == DEGENERATE else ""
    return found.get(next(iter(outputs))) if len(outputs) == 1 else found


def arrays_of(record_type, record, usual):
    """(name, dtype, array) of what a record holds, each in the type that the catalogue says. What it
    does not name goes on with a record of the host as long as nothing of that was changed."""
    fields = CATALOGUE[record_type]
    memories = {}
    if isinstance(record, GivenRecord):
        memories = record._memories
        if record._is_as_read():
            for name, memory in memories.items():
                if name not in fields and not name.startswith(("diag.", "model.")):
                    array = np.asarray(memory)
                    yield name, CODES[array.dtype], array
        values = {name: getattr(record, name) for name in memories if name in fields}
    else:
        values = {**usual, **{name: value for name, value in vars(record).items()
                              if name not in ("diag", "model", "degenerate_reason")}}
    for name, value in values.items():
        if value is None:
            continue
        if name not in fields:
            raise TypeError(f"{record_type} has no array '{name}'; it may have: {', '.join(fields)}")
        yield name, fields[name][0], as_array(record_type, name, value, fields[name])
    for prefix, named in (("diag.", record.diag), ("model.", record.model)):
        for name, value in named.items():
            full = prefix + name
            is_read = full in memories and record._views[full] is value
            yield full, *named_array(memories[full] if is_read else value)


def named_array(value):
    """(dtype, array) of evidence: arrays and numbers of NumPy keep their type, others are f64."""
    array = np.asarray(value)
    if not isinstance(value, (bool, int, float, list, tuple)) and array.dtype in CODES:
        return CODES[array.dtype], array
    return 8, np.asarray(value, np.float64)


def as_array(record_type, name, value, field):
    dtype, _, is_text, _ = field
    if is_text and isinstance(value, str):
        return np.frombuffer(value.encode(), np.uint8)
    array = np.asarray(value)
    wanted = np.dtype(DTYPES[dtype])
    if array.dtype == wanted:
        return array
    if not np.can_cast(array.dtype, wanted, "same_kind") and not (array.dtype == bool):
        raise TypeError(f"array '{name}' of {record_type} has elements of type {array.dtype} where {wanted} "
                        "is expected")
    return array.astype(wanted)

# SPDX-License-Identifier: Apache-2.0
"""Parameters, as attributes of a class: `radius_px = weft.number(60.0, "px", (1, 1000), "...")`.

One declaration each. In an instance the attribute is the value. From the declaration come the checks
of the host, the manifest, the tables of pages and the editor's schema.
"""


class Parameter:
    """A declaration; `kind` is the type as manifests call it."""

    def __init__(self, kind, default, meaning, *, unit="", bounds=None, choices=(), role="",
                 required=False, is_list=False):
        self.kind, self.default, self.meaning = kind, default, meaning
        self.unit, self.bounds, self.choices, self.role = unit, bounds, tuple(choices), role
        self.required, self.is_list = required, is_list
        self.name = ""

    def __set_name__(self, owner, name):
        self.name = name

    def check(self, value):
        """Refuses a value that the declaration does not allow."""
        if self.bounds is not None:
            for each in value if self.is_list else [value]:
                if not self.bounds[0] <= each <= self.bounds[1]:
                    raise ValueError(f"parameter '{self.name}' is outside its range")
        if self.kind == "choice" and value not in self.choices:
            raise ValueError(f"parameter '{self.name}' is none of its choices")


def number(default, unit, bounds, meaning, *, required=False):
    """A number. `bounds` are the least and the largest legal one, or None."""
    return Parameter("f64", float(default), meaning, unit=unit, bounds=bounds, required=required)


def whole(default, unit, bounds, meaning, *, required=False):
    """A whole number."""
    return Parameter("i64", int(default), meaning, unit=unit, bounds=bounds, required=required)


def numbers(default, unit, bounds, meaning, *, required=False):
    """A list of numbers, each within the bounds."""
    return Parameter("f64", [float(each) for each in default], meaning, unit=unit, bounds=bounds,
                     required=required, is_list=True)


def wholes(default, unit, bounds, meaning, *, required=False):
    """A list of whole numbers; likewise."""
    return Parameter("i64", [int(each) for each in default], meaning, unit=unit, bounds=bounds,
                     required=required, is_list=True)


def flag(default, meaning):
    """True or false."""
    return Parameter("bool", bool(default), meaning)


def choice(default, choices, meaning):
    """One of several words."""
    return Parameter("choice", default, meaning, choices=choices)


def text(default, meaning, *, required=False):
    return Parameter("text", default, meaning, required=required)


def texts(default, meaning, *, required=False):
    """A list of texts."""
    return Parameter("text", [str(each) for each in default], meaning, required=required, is_list=True)


def input_path(default, meaning, *, required=False):
    """A file to read; absolute in an instance."""
    return Parameter("input_path", default, meaning, required=required)


def output_path(default, meaning):
    """A file or folder to write, the only place where a component writes; absolute in an instance."""
    return Parameter("output_path", default, meaning)


def labels(meaning):
    """A map from text to text; a dict in an instance."""
    return Parameter("labels", {}, meaning)


def component(role, default, meaning):
    """Another component, `role` being its folder, such as `warps`. In an instance it has the methods
    of its role: `self.warp.fit(given, correspondences=..., template=...)`."""
    return Parameter("component", default, meaning, role=role)


def parameters_of(component_class):
    """The declarations of a class and of those that it is made of, in their order."""
    found = {}
    for each in reversed(component_class.__mro__):
        found.update((name, value) for name, value in vars(each).items()
                     if isinstance(value, Parameter))
    return found

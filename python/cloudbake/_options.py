"""Keyword arguments as options of the command line, from the table in C++ (pipeline/options/options.h)."""

from __future__ import annotations

import difflib
import functools
import json
import os
import re
import textwrap
from typing import Any

from . import _cloudbake
from .errors import UsageError


@functools.cache
def table(function: str) -> dict[str, dict[str, Any]]:
    """The options of a function by their names in Python."""
    name = "bake" if function == "fit" else function
    options = {option["name"].replace("-", "_"): option for option in json.loads(_cloudbake.options(name))}
    if function == "fit":
        del options["lobe"]
    return options


def texts(function: str, given: dict[str, Any]) -> list[tuple[str, str | bytes]]:
    """The options as pairs of texts, in the order of the table, as the command takes them. None stands for the default."""
    for name in given:
        if name not in table(function):
            raise UsageError(f"cloudbake.{function} has no option '{name}': {_cure(function, name)}")
    pairs: list[tuple[str, str | bytes]] = []
    for name, option in table(function).items():
        value = given.get(name)
        if value is not None:
            values = _variables(value) if "=" in option["shape"] else [value]
            pairs += [(option["name"], _text(option, one)) for one in values]
    return pairs


def _cure(function: str, name: str) -> str:
    others = [other for other in ("bake", "bake_file", "grow", "check") if name in table(other)]
    near = difflib.get_close_matches(name, table(function), 1)
    if others:
        return f"cloudbake.{others[0]} has it"
    return f"did you mean '{near[0]}'?" if near else f"help(cloudbake.{function}) lists them"


def _variables(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return [f"{name}={_number(name, number)}" for name, number in value.items()]
    return [value] if isinstance(value, str) else list(value)


def _text(option: dict[str, Any], value: Any) -> Any:
    if option["is_file"] and isinstance(value, (str, bytes, os.PathLike)):
        return os.fsencode(value)
    if isinstance(value, str):
        return value
    if isinstance(value, (tuple, list, set, frozenset)) or getattr(value, "shape", None):
        return _joined(option, list(value))
    return _number(option["name"], value)


# (0.5, 2) → "0.5:2"; ((10, 60), (0, 360)) → "10:60,0:360"; ("orient", "fill") → "orient,fill"; (4, 2, 4) → "4x2x4" where a box is wanted.
def _joined(option: dict[str, Any], values: list[Any]) -> str:
    shape = option["shape"]
    inner = [_text({**option, "shape": ":"}, value) for value in values]
    comma = "," in shape or any(isinstance(value, str) for value in values)
    return ("," if comma else "x" if "x" in shape else ":").join(inner)


def _number(name: str, value: Any) -> str:
    if isinstance(value, bool) or type(value).__name__ == "bool_":
        return "true" if value else "false"
    if hasattr(value, "__index__"):
        return str(value.__index__())
    if hasattr(value, "__float__"):
        return repr(float(value))
    raise UsageError(f"--{name}: a {type(value).__name__} is not a value of an option: give a number, a text, True or False, or a tuple")


def explained(function: str, intro: str) -> str:
    """A docstring: the introduction, then the options as the help of the command has them."""
    lines = [textwrap.dedent(intro).strip(), "", "Options:"]
    for name, option in table(function).items():
        unit = option["unit"] and f" {option['unit']}"
        fallback = option["fallback"] and f" [{option['fallback']}]"
        words = re.sub(r"--([a-z][a-z-]*)", lambda match: match[1].replace("-", "_"), option["help"] + fallback)
        lines.append(f"  {name}{unit}")
        lines += textwrap.wrap(words, 96, initial_indent="      ", subsequent_indent="      ")
    return "\n".join(lines)

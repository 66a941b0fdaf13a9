"""The exceptions of the package. All have the place that is wrong and what was expected there, as far as it is known."""
from __future__ import annotations

import builtins
import re


class Error(Exception):
    """Something that the core refused or could not do.

    file, line, column: the place that is wrong; line and column count from 1 and are None where there is none.
    wrong, expected: what is wrong, and what would have been right; expected may be empty.
    """

    file: str | None
    line: int | None
    column: int | None
    wrong: str
    expected: str

    def __init__(self, message: str, file: str | None = None, line: int | None = None, column: int | None = None,
                 wrong: str = "", expected: str = "") -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.column = column
        self.wrong = wrong or message
        self.expected = expected


class UsageError(Error, ValueError):
    """An argument, a key of a configuration or a combination of them is wrong."""


class InputError(Error, ValueError):
    """A scan, a scene or another input cannot be read or gives no surface."""


class DeviceError(Error, RuntimeError):
    """A haptic device is missing or at fault."""


class Failure(Error, RuntimeError):
    """The work could not be done, e.g. since the disk is full or a limit of memory cannot be kept."""


class Warning(builtins.UserWarning):  # noqa: A001
    """What the core warns of, by the module `warnings`."""


_OF_KIND = {1: Failure, 2: UsageError, 3: InputError, 4: DeviceError}


def of_core(kind: int, message: str, file: str, line: int, column: int, wrong: str, expected: str) -> Error:
    """The exception for an error of the core; called by the module _core."""
    message, wrong, expected = (_as_arguments(text) for text in (message.removeprefix("error: "), wrong, expected))
    file = file.replace("--set ", "")  # of a key in place of a file
    return _OF_KIND.get(kind, Failure)(message, file or None, line or None, column or None, wrong, expected)


_FLAGS = {"force", "front", "haptics", "nodes", "trust"}


def _as_arguments(text: str) -> str:
    """Arguments of the package, where the program names its options: "--size-mm" is size_mm, "--nodes" is nodes=True,
    "--holes leave" is holes='leave', and keys and devices are by their names alone. What stands between ` is a command."""
    text = text.replace(" and no --headless", "")

    def argument(match: re.Match[str]) -> str:
        option, value = match[1], match[2]
        if option is None:
            return match[0]
        if option in ("set", "device"):
            return value or "the device" if option == "device" else value or "a key"
        name = str(option).replace("-", "_")
        if name in _FLAGS:
            return f"{name}=True" + (f" {value}" if value else "")
        if value and re.fullmatch(r"\d+[kMG]?B|leave|close", value):
            return f"{name}='{value}'"
        return name + (f" {value}" if value else "")
    return re.sub(r"`[^`]*`|(?<![\w-])--([a-z][a-z-]*)(?: ([\w.\[\]]+))?", argument, text)

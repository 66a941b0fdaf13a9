"""The exceptions of the package. All have the place that is wrong and what was expected there, as far as it is known."""
from __future__ import annotations

import builtins


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
    message, file, expected = (_without_options(text) for text in (message.removeprefix("error: "), file, expected))
    return _OF_KIND.get(kind, Failure)(message, file or None, line or None, column or None, wrong, expected)


def _without_options(text: str) -> str:
    """Keys and devices by their names alone, where the program names the options that they are given by."""
    return text.replace("--set ", "").replace("--device ", "")

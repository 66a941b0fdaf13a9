"""Python's values as the text of a configuration. JSON is YAML, which the core reads with its own messages."""
from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

_MOST = 100000  # numbers of an array; a configuration is at most 1 MB of text


def _plain(value: Any) -> Any:
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if np.ma.is_masked(value):  # type: ignore[no-untyped-call]
        raise TypeError(f"a configuration cannot hold masked numbers: {value!r}")
    if hasattr(value, "tolist") and getattr(value, "size", 0) <= _MOST:  # arrays and numbers of NumPy
        plain = value.tolist()
        if isinstance(plain, (bool, int, float, str, list)):
            return plain
    raise TypeError(f"a configuration cannot hold {type(value).__name__}: {value!r}")


def text(value: Any) -> str:
    """The value as JSON."""
    return json.dumps(value, default=_plain, ensure_ascii=False)


def assignments(settings: Mapping[str, Any], before: str = "") -> list[str]:
    """{"grid": {"size": 400}} as ["grid.size=400"], in the order of the keys; a list or a number is one value."""
    found: list[str] = []
    for key, value in settings.items():
        path = before + str(key)
        if isinstance(value, dict) and value:
            found += assignments(value, path + ".")
        else:
            found.append(f"{path}={text(value)}")
    return found

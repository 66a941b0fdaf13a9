"""Python's values as the text of a configuration. JSON is YAML, which the core reads with its own messages."""
from __future__ import annotations

import base64
import json
import os
import re
from typing import Any

import numpy as np

_MOST = 100000  # numbers of an array; a configuration is at most 1 MB of text


def _plain(value: Any) -> Any:
    if isinstance(value, (bytes, os.PathLike)):
        return os.fsdecode(value)
    if np.ma.is_masked(value):  # type: ignore[no-untyped-call]
        raise TypeError(f"a configuration cannot hold masked numbers: {value!r}")
    if hasattr(value, "tolist") and getattr(value, "size", 0) <= _MOST:  # arrays and numbers of NumPy
        plain = value.tolist()
        if isinstance(plain, (bool, int, float, str, list)):
            return plain
    raise TypeError(f"a configuration cannot hold {type(value).__name__}: {value!r}")


def _scalar(token: re.Match[str]) -> str:
    """A JSON string; as YAML's !!binary where it stands for bytes that are no UTF-8, as names of files may have."""
    if token[0].isascii() and "\\u0000" not in token[0]:
        return token[0]
    plain = json.loads(token[0])
    if "\0" in plain:
        raise ValueError(f"a configuration cannot hold a NUL character: {plain!r}")
    try:
        plain.encode()
    except UnicodeEncodeError:
        return f'!!binary "{base64.b64encode(plain.encode(errors="surrogateescape")).decode()}"'
    return token[0]


def text(value: Any) -> str:
    """The value as JSON, names of files that are no UTF-8 as YAML's !!binary."""
    return re.sub(r'"(?:[^"\\]|\\.)*"', _scalar, json.dumps(value, default=_plain, ensure_ascii=False))


def assignments(settings: dict[str, Any], before: str = "", within: tuple[int, ...] = ()) -> list[str]:
    """{"grid": {"size": 400}} as ["grid.size=400"], in the order of the keys; a list or a number is one value."""
    if id(settings) in within:
        raise ValueError(f"a configuration cannot hold itself: {before.rstrip('.')}")
    found: list[str] = []
    for key, value in settings.items():
        path = before + str(key)
        if isinstance(value, dict) and value:
            found += assignments(value, path + ".", (*within, id(settings)))
        else:
            found.append(f"{path}={text(value)}")
    return found

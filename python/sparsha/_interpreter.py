"""Why the module cannot be imported by this Python, in one sentence."""
from __future__ import annotations

import contextlib
import importlib.util
import pathlib
import re
import sys
from collections.abc import Iterator


@contextlib.contextmanager
def explaining() -> Iterator[None]:
    """Around the import of the module."""
    try:
        yield
    except ImportError as error:
        raise explained(error) from None


def explained(error: ImportError) -> ImportError:
    """The ImportError that says what to do; the same one where nothing more is known."""
    made_for = [f"{tag[0]}.{tag[1:]}" for path in pathlib.Path(__file__).parent.glob("_core.cpython-*.so")
                for tag in re.findall(r"cpython-(\d+)", path.name)]
    own = f"{sys.version_info.major}.{sys.version_info.minor}"
    if error.name == "sparsha._core" and made_for and own not in made_for:
        return ImportError(f"sparsha was built for Python {', '.join(made_for)}, and {sys.executable} is Python {own}; "
                           "use another interpreter, e.g. /usr/bin/python3", name="sparsha._core")
    if importlib.util.find_spec("numpy") is None:  # which the module loads
        return ImportError(f"{sys.executable} has no NumPy, which sparsha needs (Debian's /usr/bin/python3: python3-numpy)",
                           name="numpy")
    return error

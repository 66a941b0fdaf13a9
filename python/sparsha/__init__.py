"""Sparsha: raw scans of cultural heritage, made into surfaces that can be touched.

    import sparsha
    scene = sparsha.build("statue.ply", grid={"size": 400})
    heights = scene.heights()        # (ny, nx), metres

Lengths are metres, forces newtons, times seconds, unless a name says otherwise.
"""
from ._core import Cloud, Renderer, Scene, Trace, __version__, build, open, read
from ._errors import DeviceError, Error, Failure, InputError, UsageError, Warning

__all__ = [
    "Cloud", "DeviceError", "Error", "Failure", "InputError", "Renderer", "Scene", "Trace", "UsageError", "Warning",
    "build", "open", "read",
]

"""Sparsha: raw scans of cultural heritage, made into surfaces that can be touched.

    import sparsha
    scene = sparsha.build("statue.ply", grid={"size": 400})
    heights = scene.heights()                                   # (ny, nx), metres
    proxy, force = sparsha.Renderer(scene).step((0.1, 0.2, 0.0))

Lengths are metres, forces newtons, times seconds, unless a name says otherwise.
"""
from ._interpreter import explaining as _explaining

with _explaining():
    from ._core import (Cloud, Renderer, Scene, Trace, __version__, bench_export, bench_judge, build, export,  # noqa: A004
                        monitor, open, read, register, simulate)
from ._errors import DeviceError, Error, Failure, InputError, UsageError, Warning  # noqa: A004

__all__ = [
    "Cloud", "DeviceError", "Error", "Failure", "InputError", "Renderer", "Scene", "Trace", "UsageError", "Warning",
    "__version__", "bench_export", "bench_judge", "build", "export", "monitor", "open", "read", "register", "simulate",
]

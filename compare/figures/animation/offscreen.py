"""Off-screen three-dimensional rendering, in a separate process.

VTK kills a process in which it cannot render; the caller then gets an error message instead.
"""

import ctypes
import os
import sys
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

from cases.errors import SceneError
from compare.figures.animation.snapshots import SceneSnapshots
from compare.figures.animation.view_settings import ViewSettings
from compare.runs.workers import Workers

#: On Linux, in order of preference: VTK's window, and the libraries that it needs.
WINDOWS = {
    "vtkEGLRenderWindow": ("libEGL.so.1",),
    "vtkOSOpenGLRenderWindow": ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"),
}
CHOICE = "VTK_DEFAULT_OPENGL_WINDOW"  # in the environment
NEEDED = "VTK cannot render here: it needs EGL or OSMesa (apt install libegl1, or libosmesa6)"


def has_display() -> bool:
    """Return whether a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def draw(path: Path, simulated: SceneSnapshots, settings: ViewSettings, i: int) -> None:
    """Write the pillars at instant i as PNG; raises SceneError if VTK cannot render."""
    with Workers(1) as pool:
        try:
            pool.submit(_draw, str(path), simulated, settings, i).result()
        except BrokenProcessPool:
            raise SceneError("view", "", None, NEEDED) from None


def _draw(path: str, simulated: SceneSnapshots, settings: ViewSettings, i: int) -> None:
    if sys.platform.startswith("linux"):
        os.environ.setdefault(CHOICE, _window())
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    from compare.figures.animation.view3d import View3D

    View3D(simulated, settings).picture(path, i)


def _window() -> str:
    """Return the first of VTK's windows whose library is installed; raises SceneError if none."""
    for window, libraries in WINDOWS.items():
        if any(_loads(library) for library in libraries):
            return window
    raise SceneError("view", "", None, NEEDED)


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True

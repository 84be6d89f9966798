"""Bodies in space by PyVista: in a window, or off screen as a part of a figure."""

import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from importlib.util import find_spec
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable

from jointwave.compare.figures.animation.bodies import EDGE, MARGIN, TOWARDS
from jointwave.compare.figures.animation.polygons import Polygons

#: Renders one picture; VTK ends a process in which it cannot.
TRIAL = "import pyvista; pyvista.Plotter(off_screen=True).screenshot(return_img=True)"


@cache
def can_render() -> bool:
    """Return whether PyVista is installed and VTK can render here without a display."""
    if find_spec("pyvista") is None:
        return False
    return subprocess.run([sys.executable, "-c", TRIAL], capture_output=True).returncode == 0


class Stage:
    """Bodies in space in a window or picture of PyVista.

    bodies : one below the other. towards : the direction to the viewer.
    """

    def __init__(
        self,
        bodies: Sequence[Polygons],
        colours: ScalarMappable,
        size: tuple[int, int],
        towards: tuple[float, float, float] = TOWARDS,
        **bar: Any,
    ) -> None:
        """size : pixels. bar : settings of a bar of the colours; without, there is none and no
        window."""
        import pyvista
        from vtkmodules.vtkCommonCore import vtkLogger

        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # it tells of displays it tries
        self.bodies = bodies
        self.plotter = pyvista.Plotter(off_screen=not bar, window_size=list(size))
        self.plotter.set_background("white")
        self.plotter.enable_anti_aliasing("ssaa")
        low, high = np.stack([body.reach() for body in bodies], axis=1)
        self.apart = np.array([0.0, 0.0, -1.3 * float((high - low)[:, 2].max())])
        self.meshes = []
        for body in bodies:
            corners = np.full((len(body.faces), 1), body.faces.shape[1])
            mesh = pyvista.PolyData(body.rest.copy(), np.hstack([corners, body.faces]).ravel())
            mesh.cell_data["value"] = body.values[0]
            self.meshes.append(mesh)
            self.plotter.add_mesh(
                mesh,
                scalars="value",
                cmap=colours.get_cmap(),
                clim=list(colours.get_clim()),
                show_edges=True,
                edge_color=EDGE,
                show_scalar_bar=bool(bar),
                scalar_bar_args=bar,
                ambient=0.7,  # a little shade shows the form and leaves the colours as in the bar
                diffuse=0.35,
            )
        low, high = low.min(axis=0), high.max(axis=0)
        self._point_camera(low + self.apart * (len(bodies) - 1), high, np.array(towards))

    def show(self, i: int) -> None:
        """Update the bodies to an instant."""
        for k, (body, mesh) in enumerate(zip(self.bodies, self.meshes, strict=True)):
            mesh.points = body.rest + body.motion[i] + k * self.apart
            mesh.cell_data["value"] = body.values[i]
        self.plotter.render()

    def image(self, i: int) -> np.ndarray:
        """Return the picture of an instant, uint8 array [height, width, 3]."""
        self.show(i)
        return np.asarray(self.plotter.screenshot(return_img=True))

    def _point_camera(self, low: np.ndarray, high: np.ndarray, towards: np.ndarray) -> None:
        """Show the cuboid from low to high from a direction, as large as it fits."""
        towards = towards / np.linalg.norm(towards)
        right = np.cross([0.0, 0.0, 1.0], towards)
        right /= np.linalg.norm(right)
        size = high - low
        wide, tall = (float(np.abs(axis) @ size) for axis in (right, np.cross(towards, right)))
        across, up = self.plotter.window_size
        camera = self.plotter.camera
        camera.focal_point = (low + high) / 2
        camera.position = (low + high) / 2 + 2 * float(np.linalg.norm(size)) * towards
        camera.up = (0.0, 0.0, 1.0)
        camera.enable_parallel_projection()
        camera.parallel_scale = MARGIN * max(tall, wide * up / across) / 2
        self.plotter.renderer.ResetCameraClippingRange()


class RenderedView:
    """A body in space, by PyVista, as an image in axes."""

    def __init__(self, ax: Axes, body: Polygons, colours: ScalarMappable) -> None:
        ax.set_axis_off()
        extent = ax.get_window_extent()
        size = round(extent.width), round(extent.height)
        self.stage = Stage([body], colours, size)
        self.picture = ax.imshow(self.stage.image(0), aspect="auto", interpolation="none")

    def show(self, i: int) -> None:
        """Update the picture to an instant."""
        self.picture.set_data(self.stage.image(i))


def open_window(
    bodies: dict[str, Polygons], colours: ScalarMappable, label: str, time: np.ndarray, i: int
) -> None:
    """Open a window of bodies at an instant, with a slider over all of them; return when closed.

    label : of the colours. time : the instants, s.
    """
    stage = Stage(list(bodies.values()), colours, (1280, 720), title=label, position_x=0.5)
    stage.plotter.add_text(" above ".join(bodies), font_size=11, color="black")
    stage.show(i)
    stage.plotter.add_slider_widget(
        lambda ms: stage.show(int(np.abs(1e3 * time - ms).argmin())),
        [float(1e3 * t) for t in time[[0, -1]]],
        value=float(1e3 * time[i]),
        title="time (ms)",
        color="black",
        pointa=(0.05, 0.1),
        pointb=(0.45, 0.1),
    )
    stage.plotter.show()

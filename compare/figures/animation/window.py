"""Bodies in space in a window of PyVista."""

import numpy as np
import pyvista

from jointwave.compare.engines import label_of
from jointwave.compare.figures.animation.bodies import EDGE
from jointwave.compare.figures.animation.frame import Frame

TOWARDS = 0.05, -1.0, 0.35  # to the viewer, in the axes of a body


def open_window(frame: Frame, i: int) -> None:
    """Open a window of a frame's bodies at instant i, one below the other, with a slider over all
    instants; return when it is closed."""
    bodies, time = frame.bodies, frame.time
    plotter = pyvista.Plotter(window_size=[1280, 720])
    apart = np.array([0.0, 0.0, -1.3 * max(np.ptp(body.rest[:, 2]) for body in bodies.values())])
    meshes = [pyvista.PolyData.from_regular_faces(b.rest, b.faces) for b in bodies.values()]

    def show(ms: float) -> None:
        at = int(np.abs(1e3 * time - ms).argmin())
        for k, (body, mesh) in enumerate(zip(bodies.values(), meshes, strict=True)):
            mesh.points = body.rest + body.motion[at] + k * apart
            mesh.cell_data["value"] = body.values[at]

    show(1e3 * time[i])
    for mesh in meshes:
        plotter.add_mesh(
            mesh,
            scalars="value",
            cmap=frame.colours.get_cmap(),
            clim=list(frame.colours.get_clim()),
            show_edges=True,
            edge_color=EDGE,
            scalar_bar_args={"title": frame.settings.quantity.label},
            lighting=False,  # colours as in the bar
        )
    plotter.add_text(" above ".join(map(label_of, bodies)), font_size=11)
    first, last = (float(1e3 * t) for t in time[[0, -1]])
    plotter.add_slider_widget(show, [first, last], value=float(1e3 * time[i]), title="time (ms)")
    plotter.view_vector(TOWARDS, viewup=(0.0, 0.0, 1.0))
    plotter.enable_parallel_projection()
    plotter.camera.zoom(1.6)
    plotter.show()

"""Snapshots of a pillar in space, coloured by its stress."""

from matplotlib.figure import Figure

from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.animation.bodies import OBLIQUE, BodyView, body_of, colours_of
from jointwave.compare.figures.animation.settings import settings_for
from jointwave.compare.figures.export import blank
from jointwave.results.snapshots import Snapshots

HEAD, STRIP = 0.7, 0.95  # inches above, and of a pillar


def draw_snapshots(name: str, scene: Scene, s: Snapshots) -> Figure:
    """Return a figure of snapshots one below the other, with exaggerated displacements.

    The pillar of instant i is the SVG group NAME-i.
    """
    settings = settings_for(scene, {"": s})
    body = body_of(s, scene, settings)
    colours = colours_of([body.values], settings.quantity.sign)
    with blank(HEAD + STRIP * len(s.time)) as figure:
        axes = figure.subplots(len(s.time), 1, squeeze=False)[:, 0]
        for i, (ax, time) in enumerate(zip(axes, s.time, strict=True)):
            view = BodyView(ax, body, colours, OBLIQUE)
            view.show(i)
            view.faces.set_gid(f"{name}-{i}")
            ax.set(xticks=[], yticks=[], frame_on=False)
            ax.set_ylabel(f"{1e3 * time:g} ms", rotation=0, ha="right", va="center")
        axes[-1].set_xlabel(f"y to the right; {settings.caption}")
        label = settings.quantity.label
        figure.colorbar(colours, ax=axes, label=label, location="top", shrink=0.4, aspect=30)
    return figure

"""Commands that show the wave: as an animation, and in three dimensions."""

import os
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import typer

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import (
    JsonOption,
    SceneArgument,
    SetOption,
    StrictOption,
    app,
    load,
)

ScaleOption = Annotated[
    float | None,
    typer.Option(metavar="X", help="Exaggeration of displacements (default: visible)."),
]
OneVariantOption = Annotated[str, typer.Option(help="Use this variant instead of the base scene.")]
FRAMES, SECONDS = 201, 10.0


@app.command()
def animate(
    scene: SceneArgument,
    changes: SetOption = [],
    variant: OneVariantOption = "",
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help=".mp4 or .gif; default SCENE.mp4 here.")
    ] = None,
    scale: ScaleOption = None,
    frames: Annotated[int, typer.Option(min=2, max=5000, help="Number of frames.")] = FRAMES,
    seconds: Annotated[float, typer.Option(help="Length of the animation.")] = SECONDS,
    strict: StrictOption = False,
    as_json: JsonOption = False,
) -> None:
    """Animate the blocks and the wave of both engines as MP4 or GIF.

    The frame gives the exaggeration of displacements. The continuum is the jointed rock if it
    applies, else the homogenised rock; if neither does, the frame gives the reason. A rock mass is
    coloured by particle speed.
    """
    _require_positive("--scale", scale)
    _require_positive("--seconds", seconds)
    from jointwave.compare.figures.animation import video
    from jointwave.compare.figures.animation.frame import Frame
    from jointwave.compare.figures.animation.settings import settings_for

    (one,) = load(scene, changes, variant, strict)
    path = out or Path(f"{_name(scene, one)}.mp4")
    video.refuse(path, frames)
    simulated = _simulate(one, frames)
    settings = settings_for(simulated.scene, simulated.found, scale)
    with terminal.progress("pictures") as advance:
        frame = Frame(simulated, settings, video.DOTS[path.suffix])
        video.write_video(path, frame.figure, frame.show, frames, seconds, advance)
    if not as_json:
        _say(path, simulated, settings.scale)
        return
    facts = {"file": str(path), "engines": list(simulated.found)}
    terminal.print_json(facts | {"not_shown": simulated.reasons, "scale": settings.scale})


@app.command()
def view(
    scene: SceneArgument,
    changes: SetOption = [],
    variant: OneVariantOption = "",
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write this .png, open no window.")
    ] = None,
    time: Annotated[
        float | None, typer.Option(metavar="T", help="s (default: middle of the scene).")
    ] = None,
    scale: ScaleOption = None,
    strict: StrictOption = False,
) -> None:
    """Show a scene by both engines, displaced and coloured by the wave.

    Pillars are shown in three dimensions, rock masses in their plane, coloured by displacement
    magnitude. Opens a window of PyVista with a slider over time; with --out, or without a display
    or PyVista, writes an image at the time T.
    """
    _require_positive("--scale", scale)
    (one,) = load(scene, changes, variant, strict)
    at = one.time.duration / 2 if time is None else time
    if not 0 < at <= one.time.duration:
        allowed = f"must be greater than 0 and at most time.duration = {one.time.duration:g} s"
        raise SceneError("--time", "", None, f"{allowed}, not {at:g}")
    if out is None and _has_display() and find_spec("pyvista") is not None:
        _open_window(one, at, scale)
    else:
        _write_picture(out or Path(f"{_name(scene, one)}.png"), one, at, scale)


def _open_window(scene: AnyScene, time: float, scale: float | None) -> None:
    from jointwave.compare.figures.animation.frame import colours_of
    from jointwave.compare.figures.animation.polygons import polygons_of
    from jointwave.compare.figures.animation.rendered import open_window
    from jointwave.compare.figures.animation.settings import DISPLACEMENT, settings_for

    simulated = _simulate(scene, FRAMES)
    settings = settings_for(simulated.scene, simulated.found, scale, DISPLACEMENT)
    bodies = {n: polygons_of(s, scene, settings) for n, s in simulated.found.items()}
    i = round(time / scene.time.duration * (FRAMES - 1))
    colours = colours_of(list(bodies.values()), settings)
    open_window(bodies, colours, settings.quantity.label, simulated.time, i)


def _write_picture(path: Path, scene: AnyScene, time: float, scale: float | None) -> None:
    from jointwave.compare.figures.animation.frame import Frame
    from jointwave.compare.figures.animation.settings import DISPLACEMENT, settings_for
    from jointwave.compare.figures.animation.snapshots import until
    from jointwave.compare.figures.export import write_drawing
    from jointwave.compare.runs.output import refuse_foreign

    if path.suffix != ".png":
        raise SceneError("--out", str(path), None, "must end in .png")
    refuse_foreign(path, (b"\x89PNG",))
    simulated = _simulate(until(scene, time), 2)
    settings = settings_for(simulated.scene, simulated.found, scale, DISPLACEMENT)
    frame = Frame(simulated, settings, in_space=True)
    frame.show(1)
    write_drawing(path, frame.figure)
    _say(path, simulated, settings.scale)


def _simulate(scene: AnyScene, count: int) -> Any:
    """Return this many snapshots of a scene by both engines."""
    from jointwave.compare.figures.animation.snapshots import take

    with terminal.progress("both engines") as advance:
        return take(scene, count, advance)


def _require_positive(key: str, value: float | None) -> None:
    if value is not None and not 0 < value < float("inf"):
        raise SceneError(key, "", None, f"must be a positive number, not {value:g}")


def _name(scene: str, one: AnyScene) -> str:
    """Return what a scene's files are called where the user does not say."""
    return "-".join([Path(scene).stem, *one.name.split()])


def _has_display() -> bool:
    """Return whether a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def _say(path: Path, shown: Any, scale: float) -> None:
    terminal.say(f"{path}: {' and '.join(shown.found)}, displacements × {scale:,g}")
    for name, reason in shown.reasons.items():
        terminal.say(f"{name} is not shown: {reason}")

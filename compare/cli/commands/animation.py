"""Commands that show the wave: as an animation, and in three dimensions."""

import os
import sys
from importlib.util import find_spec
from math import inf
from pathlib import Path
from typing import Annotated, Any

import typer

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import DryOption, SceneOptions, StoredOptions, command
from jointwave.compare.engines import label_of

ScaleOption = Annotated[
    float | None,
    typer.Option(metavar="X", help="Exaggeration of displacements (default: visible)."),
]
MapOption = Annotated[
    str | None,
    typer.Option(
        "--map",
        metavar="QUANTITY",
        help="Colours: stress (default for a pillar), speed (default for a rock mass) or, for a "
        "pillar, across: the velocity across its axis.",
    ),
]
FRAMES, SECONDS = 201, 10.0


@command
def animate(
    asked: SceneOptions,
    stored: StoredOptions,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help=".mp4 or .gif (default: SCENE.mp4).")
    ] = None,
    shown: MapOption = None,
    scale: ScaleOption = None,
    frames: Annotated[
        int | None,
        typer.Option(min=2, max=5000, help=f"Frames (default: of record.fields, else {FRAMES})."),
    ] = None,
    seconds: Annotated[float, typer.Option(help="Duration of the film.")] = SECONDS,
    dry: DryOption = False,
) -> None:
    """Animate the blocks and the wave of both engines as MP4 or GIF.

    Both engines share one colour scale. Each frame gives the exaggeration of displacements and the
    part that exceeds the scale. The continuum is the jointed rock if it applies, else the
    homogenised rock. If neither applies, the frames give the reason.
    """
    _require_positive("--scale", scale)
    _require_positive("--seconds", seconds)
    from jointwave.compare.figures.animation.frame import PIXELS
    from jointwave.compare.figures.animation.video import write_video
    from jointwave.compare.runs import timings
    from jointwave.compare.runs.output import FILMS, check_out

    (one,) = asked.load(every=False)
    quantity, path = _quantity(one, shown), out or Path(f"{_name(asked, one)}.mp4")
    check_out(path, FILMS)
    folder, interval = stored.folder(asked.scene), interval_of(one, frames)
    if dry:
        _show_forecast(one, interval, folder)
        return
    frame = _frame(one, interval, (scale, quantity), folder)
    count = len(frame.time)
    with timings.measured("frames", one.kind, count), terminal.progress("pictures") as advance:

        def images():
            for i in range(count):
                yield frame.image(i)
                advance((i + 1) / count)

        write_video(path, images(), PIXELS, count / seconds)
    _say(path, frame)


@command
def view(
    asked: SceneOptions,
    stored: StoredOptions,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write this .png, open no window."),
    ] = None,
    time: Annotated[
        float | None,
        typer.Option(metavar="T", help="Instant, s (default: the middle of the scene)."),
    ] = None,
    shown: MapOption = None,
    scale: ScaleOption = None,
    dry: DryOption = False,
) -> None:
    """Show a scene by both engines, displaced and coloured by the wave.

    Pillars and scenes in space are shown in three dimensions, other rock masses in their plane, on
    one colour scale.
    Opens a window of PyVista with a slider over time. With --out, or without a display or PyVista,
    writes an image of the snapshot nearest to T: one of record.fields, else one of 201.
    """
    _require_positive("--scale", scale)
    (one,) = asked.load(every=False)
    at, end = one.time.duration / 2 if time is None else time, one.time.duration
    if not 0 < at <= end:
        allowed = f"must be greater than 0 and at most time.duration = {end:g} s"
        raise SceneError("--time", "", None, f"{allowed}, not {at:g}")
    quantity, folder = _quantity(one, shown), stored.folder(asked.scene)
    if dry:
        _show_forecast(one, interval_of(one), folder, 0)
        return
    if out is None and _has_display() and find_spec("pyvista") is not None:
        from jointwave.compare.figures.animation.window import open_window

        frame = _frame(one, interval_of(one), (scale, quantity), folder)
        open_window(frame, abs(frame.time - at).argmin())
        return
    from jointwave.compare.figures.export import write_drawing
    from jointwave.compare.runs.output import check_out

    path = out or Path(f"{_name(asked, one)}.png")
    check_out(path, (".png",))
    frame = _frame(one, interval_of(one), (scale, quantity), folder)
    frame.show(abs(frame.time - at).argmin())
    write_drawing(path, frame.figure, one.title, {"savefig.dpi": "figure"})
    _say(path, frame)


def _quantity(scene: AnyScene, name: str | None) -> Any:
    """Return the quantity of `--map`, None without; raises SceneError if a scene has none such."""
    from jointwave.compare.figures.animation.settings import quantities_of

    known = quantities_of(scene)
    if name is None:
        return None
    if name not in known:
        raise SceneError("--map", "", None, f"must be one of {', '.join(known)}, not {name}")
    return known[name]


def _show_forecast(
    scene: AnyScene, interval: float | None, stored: Any, frames: int | None = None
) -> None:
    """Print the estimated cost of both engines' snapshots and of frames; None: of all instants."""
    from jointwave.compare.cli.forecast_view import show_forecasts
    from jointwave.compare.figures.animation.snapshots import shown_engines, with_snapshots
    from jointwave.compare.runs.reuse import SNAPSHOTS
    from jointwave.compare.studies.forecast import runs_of

    seen = scene if interval is None else with_snapshots(scene, interval)
    suffix = "" if interval is None else SNAPSHOTS
    if frames is None:
        frames = round(scene.time.duration / (seen.record.fields or inf)) + 1
    runs = runs_of(shown_engines(seen), seen, stored, suffix)
    show_forecasts(runs, False, {"figures": 1, "frames": frames})


def _frame(scene: AnyScene, interval: float | None, view: tuple[Any, Any], stored: Any) -> Any:
    """Simulate a scene by both engines and return the frame of its instants, one per interval.

    view : scale of displacements and quantity of the colours, None: ours.
    """
    from jointwave.compare.figures.animation.frame import Frame
    from jointwave.compare.figures.animation.settings import settings_for
    from jointwave.compare.figures.animation.snapshots import take

    with terminal.progress("both engines") as advance:
        simulated = take(scene, interval, advance, stored)
    return Frame(simulated, settings_for(simulated.scene, simulated.found, *view))


def interval_of(scene: AnyScene, frames: int | None = None) -> float | None:
    """Return the seconds from one of so many frames to the next, absent: as many as the scene
    records snapshots, for which it is None, else FRAMES."""
    if frames is None and scene.record.fields is not None:
        return None
    return scene.time.duration / ((frames or FRAMES) - 1)


def _require_positive(key: str, value: float | None) -> None:
    if value is not None and not 0 < value < float("inf"):
        raise SceneError(key, "", None, f"must be a positive number, not {value:g}")


def _name(asked: SceneOptions, one: AnyScene) -> str:
    """Return what a scene's files are called where the user does not say."""
    return "-".join([Path(asked.scene).stem, *one.name.split()])


def _has_display() -> bool:
    """Return whether a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def _say(path: Path, frame: Any) -> None:
    shown = frame.simulated
    engines = " and ".join(map(label_of, shown.found))
    terminal.say(f"{path}: {engines}, displacements × {frame.settings.scale:,g}")
    for name, reason in shown.reasons.items():
        terminal.say(f"{label_of(name)} is not shown: {reason}")

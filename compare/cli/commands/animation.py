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
    from jointwave.compare.figures.animation.frame import PIXELS
    from jointwave.compare.figures.animation.video import refuse, write_video

    (one,) = load(scene, changes, variant, strict)
    path = out or Path(f"{_name(scene, one)}.mp4")
    refuse(path)
    frame = _frame(one, one.time.duration / (frames - 1), scale)
    with terminal.progress("pictures") as advance:

        def images():
            for i in range(frames):
                yield frame.image(i)
                advance((i + 1) / frames)

        write_video(path, images(), PIXELS, frames / seconds)
    if not as_json:
        _say(path, frame)
        return
    shown = frame.simulated
    facts = {"file": str(path), "engines": list(shown.found), "not_shown": shown.reasons}
    terminal.print_json(facts | {"scale": frame.settings.scale})


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

    Pillars are shown in three dimensions, rock masses in their plane, coloured by particle speed.
    Opens a window of PyVista with a slider over time; with --out, or without a display or PyVista,
    writes an image at the time T.
    """
    _require_positive("--scale", scale)
    (one,) = load(scene, changes, variant, strict)
    at, end = one.time.duration / 2 if time is None else time, one.time.duration
    if not 0 < at <= end:
        allowed = f"must be greater than 0 and at most time.duration = {end:g} s"
        raise SceneError("--time", "", None, f"{allowed}, not {at:g}")
    if out is None and _has_display() and find_spec("pyvista") is not None:
        from jointwave.compare.figures.animation.window import open_window

        frame = _frame(one, end / (FRAMES - 1), scale)
        open_window(frame, round(at / end * (FRAMES - 1)))
        return
    from jointwave.compare.figures.export import write_drawing
    from jointwave.compare.runs.output import refuse_foreign

    path = out or Path(f"{_name(scene, one)}.png")
    if path.suffix != ".png":
        raise SceneError("--out", str(path), None, "must end in .png")
    refuse_foreign(path, (b"\x89PNG",))
    frame = _frame(one, at, scale)
    frame.show(1)
    write_drawing(path, frame.figure, one.title, {"savefig.dpi": "figure"})
    _say(path, frame)


def _frame(scene: AnyScene, interval: float, scale: float | None) -> Any:
    """Simulate a scene by both engines and return the frame of its instants, one per interval."""
    from jointwave.compare.figures.animation.frame import Frame
    from jointwave.compare.figures.animation.settings import settings_for
    from jointwave.compare.figures.animation.snapshots import take

    with terminal.progress("both engines") as advance:
        simulated = take(scene, interval, advance)
    return Frame(simulated, settings_for(simulated.scene, simulated.found, scale))


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


def _say(path: Path, frame: Any) -> None:
    shown = frame.simulated
    terminal.say(f"{path}: {' and '.join(shown.found)}, displacements × {frame.settings.scale:,g}")
    for name, reason in shown.reasons.items():
        terminal.say(f"{name} is not shown: {reason}")

"""Commands that show the wave: as an animation, and in three dimensions."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.cli.options import (
    JsonOption,
    SceneArgument,
    SetOption,
    StrictOption,
    app,
    load,
)

if TYPE_CHECKING:
    from compare.figures.animation.snapshots import SceneSnapshots
    from compare.figures.animation.view_settings import ViewSettings

ScaleOption = Annotated[
    float | None,
    typer.Option(metavar="X", help="Exaggeration of displacements (default: visible)."),
]
OneVariantOption = Annotated[str, typer.Option(help="Use this variant instead of the base scene.")]
FRAMES, SECONDS = 201, 10.0


@app.command()
def animate(
    scene: SceneArgument,
    changes: SetOption = [],  # noqa: B006
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
    from compare.cli import terminal
    from compare.figures.animation import video

    (one,) = load(scene, changes, variant, strict)
    path = out or Path(f"{_name(scene, one)}.mp4")
    video.refuse(path, frames)
    from compare.figures.animation.frame import Frame, PlaneFrame

    simulated, settings = _simulate(one, frames, scale)
    with terminal.progress("pictures") as advance:
        kind = Frame if one.kind == "pillar" else PlaneFrame
        frame = kind(simulated, settings, video.DOTS[path.suffix])
        video.write_video(path, frame.image, frames, seconds, advance)
    _show(path, simulated, settings.scale, as_json)


def _simulate(
    scene: "AnyScene", count: int, scale: float | None
) -> tuple["SceneSnapshots", "ViewSettings"]:
    from compare.cli import terminal
    from compare.figures.animation.snapshots import take
    from compare.figures.animation.view_settings import settings_for

    with terminal.progress("both engines") as advance:
        simulated = take(scene, count, advance)
    return simulated, settings_for(simulated.scene, simulated.found, scale)


def _require_positive(key: str, value: float | None) -> None:
    if value is not None and not 0 < value < float("inf"):
        raise SceneError(key, "", None, f"must be a positive number, not {value:g}")


def _name(scene: str, one: "AnyScene") -> str:
    """Return what a scene's files are called where the user does not say."""
    return "-".join([Path(scene).stem, *one.name.split()])


def _show(path: Path, shown: "SceneSnapshots", scale: float, as_json: bool) -> None:
    from compare.cli.terminal import print_json, say

    engines, reasons = list(shown.found), shown.reasons
    if as_json:
        facts = {"file": str(path), "engines": engines, "not_shown": reasons, "scale": scale}
        print_json(facts)
        return
    say(f"{path}: {' and '.join(engines)}, displacements × {scale:,g}")
    for name, reason in reasons.items():
        say(f"{name} is not shown: {reason}")


@app.command()
def view(
    scene: SceneArgument,
    changes: SetOption = [],  # noqa: B006
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
    magnitude. Opens a window with a slider over time; with --out, or without a display, writes an
    image at the time T. Needs PyVista.
    """
    _require_positive("--scale", scale)
    _require_pyvista()
    from compare.figures.animation.offscreen import has_display

    (one,) = load(scene, changes, variant, strict)
    at = one.time.duration / 2 if time is None else time
    if not 0 < at <= one.time.duration:
        allowed = f"must be greater than 0 and at most time.duration = {one.time.duration:g} s"
        raise SceneError("--time", "", None, f"{allowed}, not {at:g}")
    if out is None and has_display():
        _open(one, at, scale)
    else:
        _write_picture(out or Path(f"{_name(scene, one)}.png"), one, at, scale)


def _require_pyvista() -> None:
    from importlib.util import find_spec

    if find_spec("pyvista") is None:
        raise SceneError("view", "", None, "needs PyVista: pip install 'jointwave[view]'")


def _open(scene: "AnyScene", time: float, scale: float | None) -> None:
    from compare.figures.animation.view3d import View3D

    window = View3D(*_simulate(scene, FRAMES, scale), window=True)
    window.add_slider(round(time / scene.time.duration * (FRAMES - 1)))
    window.open()


def _write_picture(path: Path, scene: "AnyScene", time: float, scale: float | None) -> None:
    from compare.figures.animation.offscreen import draw
    from compare.figures.animation.snapshots import until
    from compare.runs.output import refuse_foreign, write

    if path.suffix != ".png":
        raise SceneError("--out", str(path), None, "must end in .png")
    refuse_foreign(path, (b"\x89PNG",))
    simulated, settings = _simulate(until(scene, time), 2, scale)
    write(path, lambda new: draw(new, simulated, settings, 1))
    _show(path, simulated, settings.scale, False)

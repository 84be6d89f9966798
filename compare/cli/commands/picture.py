"""The command that draws a scene, or what its results look like over the whole body."""

import re
from pathlib import Path
from typing import Annotated

import typer

from jointwave.cases.errors import SceneError
from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import (
    SceneOptions,
    SetOption,
    StrictOption,
    VariantOption,
    command,
)
from jointwave.compare.engines import ENGINES
from jointwave.compare.scenes import shipped


@command
def picture(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SCENE|FOLDER",
            help="A scene; or results of `run` with snapshots, as a folder or a file.",
            autocompletion=shipped,
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help=".png, .svg or .pdf (default: NAME.png, of results NAME-MAP.png).",
        ),
    ] = None,
    quantity: Annotated[
        str | None,
        typer.Option("--map", help="Map of results: ppv (the default), speed, stress or slip."),
    ] = None,
    time: Annotated[
        float | None,
        typer.Option(metavar="T", help="Instant of the map, s (default: where it is strongest)."),
    ] = None,
    explode: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            max=10.0,
            metavar="X",
            help="Of a scene in space: move blocks apart, by X times their distance.",
        ),
    ] = None,
    changes: SetOption = [],
    variant: VariantOption = None,
    strict: StrictOption = False,
) -> None:
    """Draw a scene, or a map of its results.

    A scene is drawn with its joints, boundaries, receivers, loads and waves. Variants that look
    different have a drawing each. Results with snapshots (`run --set record.fields=1e-3`) are drawn
    as a map of the whole body: peak particle velocity, or speed, stress or slip at one instant. The
    results of two engines are drawn side by side, with their difference.
    """
    from jointwave.compare.figures.export import write_drawing
    from jointwave.compare.runs.output import check_out

    folder = Path(source)
    of_results = folder.is_dir() or folder.suffix == ".nc"
    name = re.sub(r"\.(toml|nc)$", "", folder.resolve().name)
    path = out or Path(f"{name}-{quantity or 'ppv'}.png" if of_results else f"{name}.png")
    check_out(path)
    if of_results:
        if changes or variant is not None:
            raise SceneError("--set, --variant", "", None, "are of a scene, not of a folder")
        if explode is not None:
            raise SceneError("--explode", "", None, "is of a scene in space, not of a folder")
        figure, title = _map(folder, quantity or "ppv", time)
    elif quantity is not None or time is not None:
        allowed = f"is of results: `jointwave run {source} --set record.fields=1e-3 --out FOLDER`"
        raise SceneError("--map" if quantity else "--time", "", None, f"{allowed} first")
    else:
        from jointwave.compare.figures.drawing.scene import scene_figure
        from jointwave.compare.misfit.pairs import Comparison

        scenes = SceneOptions(source, changes, variant, strict).load()
        title = scenes[0].title
        if explode is not None and not scenes[0].in_space:
            raise SceneError("--explode", "", None, f"is of a scene in space, not of {source}")
        figure = scene_figure("scene", [Comparison(one) for one in scenes], explode or 0.0).figure
    terminal.say(f"wrote {write_drawing(path, figure, title)}")


def _map(folder: Path, quantity: str, time: float | None):
    """Return the map of a folder's results, at most two, and its title."""
    from jointwave.compare.figures.body_maps import maps_of, scene_of
    from jointwave.compare.figures.charts.maps import draw_maps
    from jointwave.results.netcdf import load_netcdf

    files = [folder / f"{name}.nc" for name in ENGINES] if folder.is_dir() else [folder]
    files = [file for file in files if file.exists()]
    if not files:
        raise SceneError(str(folder), "", None, "has no result of an engine, such as dem.nc")
    results = [load_netcdf(file) for file in files[:2]]
    scene = scene_of(results[0])
    return draw_maps(maps_of(scene, results, quantity, time), scene), scene.title

"""`jointwave picture`: a scene, or what its results look like over the whole body."""

import json
import re
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure

from jointwave.cases.errors import SceneError
from jointwave.compare.cli.commands import Picture
from jointwave.compare.cli.inputs import load
from jointwave.compare.cli.terminal import say
from jointwave.compare.engines import ENGINES
from jointwave.compare.figures.body_maps import maps_of, scene_of
from jointwave.compare.figures.charts.maps import draw_maps
from jointwave.compare.figures.charts.waveforms import ASIDE
from jointwave.compare.figures.drawing.scene import scene_figure
from jointwave.compare.figures.export import write_drawing
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.runs.output import check_out
from jointwave.results.netcdf import load_netcdf


def picture(asked: Picture) -> None:
    """Draw a scene, or a map of its results."""
    source, map_of = Path(asked.scene), asked.quantity or "ppv"
    of_results = source.is_dir() or source.suffix == ".nc"
    name = re.sub(r"\.(toml|nc)$", "", source.resolve().name)
    path = asked.out or Path(f"{name}-{map_of}.png" if of_results else f"{name}.png")
    check_out(path)
    if of_results:
        if asked.changes or asked.variant is not None:
            raise SceneError("--set, --variant", "", None, "are of a scene, not of a folder")
        if asked.explode is not None:
            raise SceneError("--explode", "", None, "is of a scene in space, not of a folder")
        figure, title = _map(source, map_of, asked.time)
    elif asked.quantity is not None or asked.time is not None:
        run = f"jointwave run {asked.scene} --set record.fields=1e-3 --out FOLDER"
        key = "--map" if asked.quantity else "--time"
        raise SceneError(key, "", None, f"is of results: `{run}` first")
    else:
        scenes = load(asked)
        title = scenes[0].title
        if asked.explode is not None and not scenes[0].in_space:
            raise SceneError("--explode", "", None, f"is of a scene in space, not of {source}")
        shown = [Comparison(one) for one in scenes]
        figure = scene_figure("scene", shown, asked.explode or 0.0).figure
    say(f"wrote {write_drawing(path, figure, title)}")


def _map(folder: Path, quantity: str, time: float | None) -> tuple[Figure, str]:
    """Return the map of a folder's results, at most two, and its title."""
    files = [folder / f"{name}.nc" for name in ENGINES] if folder.is_dir() else [folder]
    files = [file for file in files if file.exists()]
    if not files:
        raise SceneError(str(folder), "", None, "has no result of an engine, such as dem.nc")
    results = [_result(file) for file in files[:2]]
    one, other = (json.loads(results[k].attrs["scene"]) for k in (0, -1))
    if differing := [key for key in one if key not in ASIDE and one[key] != other.get(key)]:
        allowed = f"has results of two scenes, by {', '.join(differing)}: name one of the files"
        raise SceneError(str(folder), "", None, allowed)
    scene = scene_of(results[0])
    return draw_maps(maps_of(scene, results, quantity, time), scene), scene.title


def _result(file: Path) -> xr.Dataset:
    """Return a result from its file; raises SceneError for any other file."""
    try:
        found = load_netcdf(file)
        found.attrs["scene"], found.attrs["engine"], found.attrs["variant"]
    except MemoryError:
        raise
    except Exception:  # the libraries raise many kinds
        raise SceneError(str(file), "", None, "is damaged, or no result of `run`") from None
    return found

"""The report's page: one section a figure, made where its figure is drawn, and the whole."""

import json
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

from jinja2 import Environment, PackageLoader

import cases
from cases.calibrate import calibrate
from cases.snapshots import snapshots_of
from compare import tables
from compare.figures import draw, save
from compare.findings import Finding, findings
from compare.output import write
from compare.pairs import Comparison
from compare.panels import curve_table
from compare.scenes import find

COMMAND = "jointwave report --out DIR"

MOVING = "beyond/eccentric-blow"  # the scene that is shown as a whole, and with which changes
CHANGES = {"record.fields": 5e-3, "time.duration": 0.035, "record.energy": False}


class Section(NamedTuple):
    """One figure of the page; `name` is that of its files ("fig-03"), `toml` its scene's text."""

    name: str
    number: int
    title: str
    source: str
    toml: str
    svg: str
    findings: list[Finding]
    misfits: tables.Table
    distances: tables.Table
    runs: tables.Table
    reasons: tables.Table


def make_section(folder: Path, scene_file: Path, comparisons: list[Comparison]) -> Section:
    """Draw a scene file's figure, write its SVG, PNG and CSV into `folder`, return its section."""
    name, scene = scene_file.stem, comparisons[0].scene
    number = int(name.rpartition("-")[2])
    svg = write_figure(folder, name, comparisons)
    return Section(
        name,
        number,
        scene.title,
        scene.source or "",
        scene_file.read_text(encoding="utf-8"),
        svg,
        findings(number, comparisons),
        tables.misfit_table(comparisons),
        tables.distance_table(comparisons),
        tables.run_table(comparisons),
        tables.reason_table(comparisons),
    )


class Motion(NamedTuple):
    """Snapshots of a whole pillar.

    file : shows them in ParaView, relative to the page. bar_speed : m/s.
    """

    title: str
    svg: str
    file: str
    bar_speed: float


def make_motion(out: Path) -> Motion:
    """Simulate the moving pillar, write its snapshots, and draw them as they are read back."""
    import dem
    from compare.fieldfiles import read_pvd, write_pvd
    from compare.snapshot_picture import draw_snapshots

    scene = cases.load_variant(find(MOVING), "", CHANGES)
    found = snapshots_of(dem.simulate_fields(scene))
    assert found is not None
    file = write_pvd(out / "fields" / "dem.pvd", found)
    figure = draw_snapshots("snapshots", {"dem": read_pvd(file).since(1)})
    svg = save(figure, out / "figures", "snapshots", scene.title)
    return Motion(scene.title, svg, file.relative_to(out).as_posix(), calibrate(scene).bar_speed)


def write_figure(folder: Path, name: str, comparisons: list[Comparison]) -> str:
    """Write NAME.svg, NAME.png, NAME.csv (curves) and NAME-misfits.csv; return the SVG's text."""
    curves, distances = curve_table(comparisons), tables.distance_frame(comparisons)
    write(folder / f"{name}.csv", lambda path: curves.to_csv(path, float_format="%.9g"))
    misfits = folder / f"{name}-misfits.csv"
    write(misfits, lambda path: distances.to_csv(path, float_format="%.9g", index=False))
    return save(draw(name, comparisons), folder, name, comparisons[0].scene.title)


def render(sections: list[Section], figures: dict[str, list[Comparison]], **parts: object) -> str:
    """Return the page's HTML; `parts` are the overview's finding and tables, and the motion."""
    environment = Environment(
        loader=PackageLoader("compare"), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    failed = [(s.number, f) for s in sections for f in s.findings if not f.holds]
    return environment.get_template("report.html").render(
        sections=sections,
        failed=failed,
        claims=sum(len(s.findings) for s in sections),
        versions=_versions(figures),
        command=COMMAND,
        **parts,
    )


def _versions(figures: dict[str, list[Comparison]]) -> dict[str, str]:
    """Return the versions of everything that computed."""
    found = {"jointwave": _version("jointwave"), "Python": platform.python_version()}
    for comparisons in figures.values():
        for result in comparisons[0].results.values():
            found |= json.loads(result.attrs.get("versions", "{}"))
    return found | {name: _version(name) for name in ("scipy", "xarray", "obspy", "matplotlib")}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # run from its folder, not installed
        return "(not installed)"

"""The commands and their options, in the order of the help."""

from pathlib import Path
from types import SimpleNamespace

import typer

from jointwave.compare.cli import options
from jointwave.compare.scenes import shipped
from jointwave.compare.solvers.dem import DEM

app = options.app
FRAMES = 201  # of an animation, if the scene records no snapshots


@options.command("scene_files:new")
class New(SimpleNamespace):
    """Write a scene to start from, NAME.toml, with every key explained.

    It runs as it is. Existing files are not overwritten.
    """

    name: str = typer.Argument(..., help="File name, with or without .toml.")
    source: str | None = typer.Option(
        None,
        "--from",
        metavar="SCENE",
        help="Copy this scene with its comments and files.",
        autocompletion=shipped,
    )
    rock_mass: bool = typer.Option(
        False, "--rock-mass", help="Write a rock mass with one joint, not a pillar."
    )


@options.command("scene_files:list_scenes")
class List(SimpleNamespace):
    """List the shipped scenes and their variants."""

    as_json: options.JsonOption = False


@options.command("explain:explain")
class Explain(options.SceneOptions):
    """Print what a scene has, its time steps, and what can solve it.

    These are its rock and blocks, incoming waves, active effects, each engine's time step and what
    limits it, the solutions that apply with their options, and the references. Nothing is run.
    """

    every: bool = typer.Option(
        False, "--all", help="Also absent effects and solutions that do not apply, and why."
    )
    as_json: options.JsonOption = False


@options.command("pictures:picture")
class Picture(options.SceneOptions):
    """Draw a scene, or a map of its results.

    A scene is drawn with its joints, boundaries, receivers, loads and waves; each variant that
    looks different has its own drawing. Results with snapshots (`run --set record.fields=1e-3`) are
    drawn as a map of the whole body: peak particle velocity, or speed, stress or slip at one
    instant. The results of two engines are drawn side by side, with their difference.
    """

    scene: str = typer.Argument(
        ...,
        metavar="SCENE|FOLDER",
        help="A scene; or results of `run` with snapshots, as a folder or a file.",
        autocompletion=shipped,
    )
    out: Path | None = typer.Option(
        None,
        metavar="FILE",
        help=".png, .svg or .pdf (default: NAME.png, of results NAME-MAP.png).",
    )
    quantity: str | None = typer.Option(
        None, "--map", help="Map of results: ppv (the default), speed, stress or slip."
    )
    time: float | None = typer.Option(
        None, metavar="T", help="Instant of the map, s (default: where it is strongest)."
    )
    section: str | None = typer.Option(
        None, metavar="AXIS=M", help="Plane of a map in space, as y=25 (m)."
    )
    explode: float | None = typer.Option(
        None,
        min=0.0,
        max=10.0,
        metavar="X",
        help="Of a scene in space: move blocks apart, by X times their distance.",
    )


@options.command("run:run")
class Run(options.PrintOptions, options.SweepOptions):
    """Simulate a scene and write its results as NetCDF files.

    The files are DIR/[variant/]ENGINE[-MODEL].nc. With record.fields, snapshots are written as
    well, as a .pvd file for ParaView. Under mpiexec the processes share each run of the
    continuum; the first process does everything else.

    Stored results are read; --fresh computes them again. With --resume a killed run continues from
    its last checkpoint, with a bit-identical result. Ctrl-C saves the partial result.

    --sweep runs the scene for every value of a key, each in DIR/KEY=VALUE/, in several
    processes. Finished points are not run again; failed ones are listed. --ensemble runs a
    scene with random joints for several seeds.
    """

    engine: options.EngineOption = [options.Engine(DEM.engine)]
    model: options.ModelOption = None
    out: Path | None = typer.Option(None, help="Folder for results (default: out/SCENE).")
    every: float = typer.Option(
        60.0,
        "--checkpoint-every",
        metavar="SECONDS",
        min=0.0,
        help="Time between two checkpoints; 0: none.",
    )
    resume: bool = typer.Option(
        False, "--resume", help="Continue an interrupted run from its checkpoint."
    )
    fresh: options.FreshOption = False


@options.command("compare:compare")
class Compare(options.PrintOptions, options.StoredOptions, options.SweepOptions):
    """Solve a scene by all that applies; say how far apart, and why.

    Prints a line per engine: its worst misfit from the finest physics, with variant and receiver,
    its reference, its own numerical error, the stepping time, and the verdict. --all, --json, --out
    and --with also run all other solvers. --all prints the misfit of every pair, and the peak ratio
    of data and model for external curves.

    --with adds a waveform of another code, figure or experiment: a table with a header such as
    "time [ms], stress@20 [MPa]", a seismogram, or a NetCDF file. A label names the curve of a file
    without names, or selects one of several: curve.csv:stress@20, "run.nc:-velocity@20.25 [mm/s]".
    With the header of a column in front it selects that column: "gauge.csv:CH 3=stress@20 [MPa]".
    Receivers of a rock mass have two coordinates: "velocity_x@[20,30]", "stress_xx@[20,30] [MPa]",
    "gap@[20,20]". The default unit is SI. Stress is positive in compression; a minus sign inverts
    a curve. Only the overlap in time is compared. Amplitudes are never scaled; times are shifted
    only by --align.

    --sweep compares the scene for every value of a key, in several processes, and writes one
    table. --ensemble compares a scene with random joints for several seeds, with statistics.
    """

    every: bool = typer.Option(
        False, "--all", help="Also every misfit, and why other solutions do not apply."
    )
    reads: bool = typer.Option(
        False, "--read", help="Also peak velocity, Arias intensity, spectra, speeds."
    )
    out: Path | None = typer.Option(
        None, help="Folder for tables, curves, figure and, without --results, results."
    )
    spectral: bool = typer.Option(
        True, help="Add envelope and phase misfit (Kristekova et al. 2006)."
    )
    given: options.WithOption = []
    align: bool = typer.Option(
        False, "--align", help="Align each --with curve by cross-correlation."
    )


class WaveOptions(options.StoredOptions):
    """Options for drawing the wave in a scene."""

    quantity: str | None = typer.Option(
        None,
        "--map",
        metavar="QUANTITY",
        help="Colours: stress (default for a pillar), speed (default for a rock mass) or, for a "
        "pillar, across: the velocity across its axis.",
    )
    scale: float | None = typer.Option(
        None, metavar="X", help="Exaggeration of displacements (default: visible)."
    )
    dry: options.DryOption = False


@options.command("pictures:view")
class View(WaveOptions):
    """Show a scene by both engines, displaced and coloured by the wave.

    Pillars and scenes in space are shown in three dimensions, other rock masses in their plane, on
    one colour scale.
    Opens a window of PyVista with a slider over time. With --out, or without a display or PyVista,
    writes an image of the snapshot nearest to T: one of record.fields, else one of 201.
    """

    out: Path | None = typer.Option(None, metavar="FILE", help="Write this .png, open no window.")
    time: float | None = typer.Option(
        None, metavar="T", help="Instant, s (default: the middle of the scene)."
    )


@options.command("pictures:animate")
class Animate(WaveOptions):
    """Animate the blocks and the wave of both engines as MP4 or GIF.

    Both engines share one colour scale. Each frame gives the exaggeration of displacements and the
    part that exceeds the scale. The continuum is the jointed rock if it applies, else the
    homogenised rock. If neither applies, the frames give the reason.
    """

    out: Path | None = typer.Option(None, metavar="FILE", help=".mp4 or .gif (default: SCENE.mp4).")
    frames: int | None = typer.Option(
        None, min=2, max=5000, help=f"Frames (default: of record.fields, else {FRAMES})."
    )
    seconds: float = typer.Option(10.0, help="Duration of the film.")


@options.command("pictures:figure")
class Figure(options.StoredOptions):
    """Draw the waveforms of a scene as a figure for a paper.

    A panel for each variant and receiver, two side by side from a width of 170 mm. Files need no
    installed fonts. Without --engine, all solvers that apply are drawn.
    """

    out: Path = typer.Option(..., help="Output file: .pdf, .svg or .png.")
    engine: options.EngineOption = []
    model: options.ModelOption = None
    given: options.WithOption = []
    width: float = typer.Option(90.0, min=60, max=1000, help="Width, mm.")
    font_size: float = typer.Option(8.0, min=4, max=40, help="Size of letters, pt.")
    dry: options.DryOption = False


@options.command("compare:report")
class Report(options.PrintOptions):
    """Write scenes, their figures, misfits and costs as one HTML page.

    The page needs no other file. Without a scene: the figures of Guo & Li (2002), the paper's
    claims, and all studies. Results are read from and stored in out/SCENE, points of studies in
    DIR.
    """

    scenes: list[str] | None = typer.Argument(
        None,
        metavar="SCENE",
        help="Scene files or shipped scenes (default: the figures of Guo & Li (2002)).",
        autocompletion=shipped,
    )
    out: Path = typer.Option(Path("report"), help="Folder for results.")
    fresh: options.FreshOption = False
    peers: Path | None = typer.Option(
        None, help="Table of make bench-peers (default: out/peers/points.csv if present)."
    )
    strict: options.StrictOption = False


@options.command("studies:plan")
class Plan(options.SceneOptions):
    """Find the cheapest engine, elements and step that meet a misfit.

    Tries runs in order of cost until one meets the misfit, and prints the command for that run.
    """

    misfit: float = typer.Option(..., help="Largest misfit, relative L2: 0.02 is 2 %.")
    seconds: float | None = typer.Option(
        None, min=0.0, help="Limit of stepping, s: the best run within it."
    )


@options.command("studies:effects")
class Effects(options.PrintOptions, options.SceneOptions):
    """Measure what every effect of a scene costs and changes.

    For each effect it prints its share of the time of a step, and the misfit of the result without
    it. The scene is a pillar, or a rock mass that rigid blocks can represent. Results are saved in
    DIR and not measured again.
    """

    out: Path = typer.Option(Path("effects"), help="Folder for table, diagram and points.")


@options.command("studies:study")
class Study(options.PrintOptions):
    """Run a study of accuracy against cost; without a name, list them.

    A scene is solved in many ways, each with its error and its cost, in a table and a diagram.
    Finished points are saved in DIR/NAME/ and not run again. Under mpiexec the processes share
    the points; those of a timed study are run one at a time. The study `stability` runs both
    engines on hard cases, each with a criterion from theory. `oblique-joint` compares reflection
    and transmission of P and SV waves at one joint with theory, `parallel-joints` at several.
    """

    name: str | None = typer.Argument(None, help="A shipped study or a study's TOML file.")
    out: Path = typer.Option(Path("studies"), help="Folder for tables and points.")
    workers: options.WorkersOption = options.CORES


@options.command("studies:fit")
class Fit(options.PrintOptions, options.SceneOptions):
    """Fit keys of a scene to measured waveforms by least squares.

    Values come with 95 % intervals, for independent residuals. Keys that the waveforms cannot
    distinguish and keys that stop at a bound are named. A search that does not converge ends with
    exit code 3.

    --free names keys by their dotted path, such as joints.normal_stiffness or
    soft_layers.0.spacing_stiffness, in a rock mass joint_sets.0.normal_stiffness or
    waves.0.amplitude, optionally with start and bounds: KEY=START or KEY=LOW:START:HIGH. The key
    clock is a shift of the times of the files in s, and starts from cross-correlation. --with is
    that of compare: quantity, place, sign and unit of every column. Amplitudes are never scaled.

    Without --engine the solver is rigid blocks, in a short chain their exact solution (lattice).

    --out writes fit.csv: values, intervals and correlations. The last line printed is a command
    that compares the fitted scene with the same files.
    """

    given: options.WithOption
    free: list[str] = typer.Option(
        ...,
        "--free",
        metavar="KEY",
        help="A key of the scene, or clock; repeatable, or separated by commas.",
    )
    engine: options.Engine | None = typer.Option(
        None, help="dem: rigid blocks (default); continuum: rock; exact: exact solutions."
    )
    model: options.ModelOption = None
    out: Path | None = typer.Option(None, help="Folder for the table fit.csv.")


@options.command("doctor:doctor")
class Doctor(SimpleNamespace):
    """Print what is installed, and check both engines.

    The engines are checked against exact solutions, and missing or broken parts are listed. The
    exit code is 0 if both engines pass, else 1. The first run compiles kernels, which takes up to a
    minute.
    """

    as_json: options.JsonOption = False

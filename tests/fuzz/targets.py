"""What meets any input: each target takes bytes as one kind of file or command and reads it.

A target returns "read" or "refused", and raises whatever no user should see: any error but
SceneError and UnstableError, a message of several lines, or a message that is too long to read. It
makes every check that a command makes before it solves something, and solves only tiny scenes of
the paper's kind, whose kernels are compiled already.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable
from contextlib import chdir, redirect_stderr, redirect_stdout
from importlib import import_module
from pathlib import Path
from time import process_time
from unittest.mock import patch

import numpy as np

from jointwave import cases
from jointwave.cases.effects import active_effects
from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.loads import load_history, step_means
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.partition.scene import blocks_of_scene, partition_bytes
from jointwave.cases.records import read_history
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.cases.warnings import warnings
from jointwave.compare.cli import program
from jointwave.compare.engines import applies, names, solver
from jointwave.compare.misfit.external import read_curves
from jointwave.compare.studies.study import load as load_study
from jointwave.compare.studies.work_precision import key
from jointwave.results.dataset import scene_hash

SECONDS = 5  # of the processor, for one input
MEMORY = "0.2"  # GB that a run may take here
LONGEST = 2000  # characters of a message
TINY = 20_000  # block steps of a run
TINY_PARTITION = 1e6  # bytes of a rock mass that is cut
FREE = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"
#: What the paper's own pillar calls for: nothing else is compiled here.
PLAIN = ["energy ledger"]


class Unreadable(AssertionError):
    """A message that is not one line."""


def _asked(work: Callable[[], object]) -> str:
    """Return what came of reading something."""
    try:
        work()
    except SceneError as error:
        for one in error.each:
            _check(str(one))
        return "refused"
    except UnstableError as error:
        _check(str(error))
        return "refused"
    return "read"


def _check(message: str) -> None:
    if not message.strip() or len(message.splitlines()) > 1 or len(message) > LONGEST:
        raise Unreadable(message[:LONGEST])


def _written(folder: Path, name: str, data: bytes) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


def scene(data: bytes, folder: Path) -> str:
    """A scene file and all that `explain` says of it."""
    path = _written(folder, "scene.toml", data)

    def work() -> None:
        for one in cases.load(path)[:3]:
            _examine(one)

    return _asked(work)


def _examine(one: Scene | RockMass) -> None:
    warnings(one)
    scene_hash(one)
    if not one.is_column:
        _examine_rock_mass(one)
        return
    calibrate(one)
    step_means(load_history(one), one.interval, 4)
    answers = {name: applies(name, one) for name in names()}
    _elements(one, [n for n in answers if n.startswith("continuum") and answers[n]])
    steps = _steps(one)
    if steps * one.pillar.block_count <= TINY and (
        active_effects(one) == PLAIN and one.numerics.dem.scheme == "leapfrog" and one.record.energy
    ):
        from jointwave.dem import simulate

        simulate(one)


def _examine_rock_mass(one: RockMass) -> None:
    """Ask what solves it, and cut it where that takes little."""
    for name in names():
        applies(name, one)
    if partition_bytes(one) <= TINY_PARTITION:
        blocks_of_scene(one)


def _steps(one: Scene) -> int:
    """Return how many steps the rigid blocks would take, after every check before the first."""
    return solver("dem").prepare(one).steps


def _elements(one: Scene, models: list[str]) -> None:
    """Ask how many elements a block would have."""
    from jointwave.continuum.mesh.size import elements_along

    for name in models:
        elements_along(one, name.removeprefix("continuum-"))


def load(data: bytes, folder: Path) -> str:
    """A load's file."""
    _written(folder, "load.csv", data)
    try:
        history, _ = read_history(folder, "load.csv", "stress")
    except ValueError as error:
        _check(str(error))
        return "refused"
    with np.errstate(over="raise", invalid="raise"):
        history.value(np.linspace(0.0, 1.0, 10))
    return "read"


def curve(data: bytes, folder: Path) -> str:
    """A file that `compare --with` names, with the place of its curve."""
    path = _written(folder, "curve", data)
    return _asked(lambda: read_curves([f"{path}:stress@20"], []))


def study(data: bytes, folder: Path) -> str:
    """A study's file, and the scenes of its first points."""
    path = _written(folder, "study.toml", data)

    def work() -> None:
        for point in load_study(str(path)).points()[:3]:
            key(point)
            _examine(point.scene)

    return _asked(work)


def mesh(data: bytes, folder: Path) -> str:
    """A gmsh file of a pillar of three blocks."""
    from jointwave.continuum.scene import body_of

    shape = {"pillar.length": 1.5, "pillar.side": 0.4, "pillar.block": 0.5, "soft_layers": []}
    places = {"record.stress": [0.5], "record.velocity": [0.25], "variants": []}
    file = {"numerics.continuum.mesh": str(_written(folder, "pillar.msh", data))}
    return _asked(lambda: body_of(cases.load_variant(FREE, "", shape | places | file)))


#: What would solve something: a command that gets so far has read all that it was given.
SOLVERS = (
    "jointwave.compare.runs.run.execute",
    "jointwave.compare.runs.comparison.compare",
    "jointwave.compare.cli.studies.on_pool",
    "jointwave.compare.studies.plan.plan",
    "jointwave.compare.report.report.build",
    "jointwave.compare.runs.comparison.solved",
    "jointwave.compare.cli.animation.take",
    "jointwave.compare.cli.explain.explanation",
    "jointwave.compare.cli.doctor.examine",
)
for name in SOLVERS:  # a module that is first imported by a command would keep what stops it
    import_module(name.rpartition(".")[0])

SOLVES = "a command would solve something"


def _stop(*_: object, **__: object) -> None:
    raise SceneError("here", "", None, SOLVES)


def command(data: bytes, folder: Path) -> str:
    """A command line, one argument a line, up to where it would solve something."""
    arguments = [os.fsdecode(part) for part in data.replace(b"\0", b"").split(b"\n")]
    said, shown = io.StringIO(), io.TextIOWrapper(io.BytesIO(), "utf-8")
    with chdir(folder), redirect_stderr(said), redirect_stdout(shown):
        code = _status(["jointwave", *arguments])
    if code == 0:
        return "read"
    lines = [x for x in said.getvalue().splitlines() if not x.startswith("jointwave: warning")]
    _check(lines[-1] if lines else "")
    if code != 2 or not lines[-1].startswith("jointwave: "):
        raise Unreadable(f"exit {code}: {said.getvalue()[:LONGEST]}")
    return "read" if SOLVES in lines[-1] else "refused"


def _status(arguments: list[str]) -> int:
    from contextlib import ExitStack

    with ExitStack() as stack:
        stack.enter_context(patch.object(sys, "argv", arguments))
        for name in SOLVERS:
            stack.enter_context(patch(name, _stop))
        try:
            program.main()
        except SystemExit as end:
            return end.code if isinstance(end.code, int) else 0
    return 0


TARGETS: dict[str, Callable[[bytes, Path], str]] = {
    target.__name__: target for target in (scene, load, curve, study, mesh, command)
}


def met(name: str, data: bytes, folder: Path) -> str:
    """Return what a target makes of an input; raises TimeoutError where it is long about it."""
    began = process_time()  # other work on the machine does not count
    outcome = TARGETS[name](data, folder)
    if process_time() - began > SECONDS:
        raise TimeoutError(f"{process_time() - began:.3g} s for one input")
    return outcome

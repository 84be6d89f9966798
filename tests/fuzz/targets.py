"""What meets any input: each target takes bytes as one kind of file or command and reads it.

A target returns "read" or "refused", and raises whatever no user should see: any error but
SceneError and UnstableError, a message of several lines, or a message that is too long to read. It
makes every check that a command makes before it solves something, and solves only tiny scenes of
the paper's kind, whose kernels are compiled already."""

import io
import os
import sys
from contextlib import ExitStack, chdir, redirect_stderr, redirect_stdout
from importlib import import_module
from pathlib import Path
from time import process_time
from unittest.mock import patch

import numpy as np
import pytest

from jointwave import cases
from jointwave.cases.effects import active_effects
from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.loads import load_history, step_means
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.partition.scene import blocks_of_scene, partition_bytes
from jointwave.cases.records import read_history
from jointwave.cases.warnings import warnings
from jointwave.compare.cli import program
from jointwave.compare.engines import applies, names, solver
from jointwave.compare.misfit.external import read_curves
from jointwave.compare.studies.study import load as load_study
from jointwave.compare.studies.work_precision import key
from jointwave.dem import simulate
from jointwave.results.dataset import scene_hash

SECONDS = 5  # of the processor, for one input
MEMORY = "0.2"  # GB that a run may take here
LONGEST = 2000  # characters of a message
TINY = 20_000  # block steps of a run
TINY_PARTITION = 1e6  # bytes of a rock mass that is cut
FREE = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"
#: What the paper's own pillar calls for: nothing else is compiled here.
PLAIN = ["energy ledger"]


def met(name, data, folder):
    """Return what a target makes of an input; raises TimeoutError where it is long about it."""
    began = process_time()  # other work on the machine does not count
    try:
        outcome = TARGETS[name](data, folder) or "read"
    except (SceneError, UnstableError) as error:
        for one in getattr(error, "each", [error]):
            check(str(one))
        outcome = "refused"
    if process_time() - began > SECONDS:
        raise TimeoutError(f"{process_time() - began:.3g} s for one input")
    return outcome


def check(message):
    """Assert that a message is one line that can be read."""
    is_line = message.strip() and len(message.splitlines()) == 1 and len(message) <= LONGEST
    assert is_line, message[:LONGEST]


def written(folder, name, data):
    (file := folder / name).write_bytes(data)
    return file


def scene(data, folder):
    """A scene file and all that `explain` says of it."""
    for one in cases.load(written(folder, "scene.toml", data))[:3]:
        examine(one)


def examine(one):
    """Make every check of a scene; cut and solve it where that takes little."""
    warnings(one)
    scene_hash(one)
    answers = {name: applies(name, one) for name in names()}
    if not one.is_column:
        return blocks_of_scene(one) if partition_bytes(one) <= TINY_PARTITION else None
    calibrate(one)
    step_means(load_history(one), one.interval, np.arange(4))
    from jointwave.continuum.mesh.size import elements_along

    for name in (name for name in answers if name.startswith("continuum") and answers[name]):
        elements_along(one, name.removeprefix("continuum-"))
    is_plain = active_effects(one) == PLAIN and one.numerics.dem.scheme == "leapfrog"
    steps = solver("dem").prepare(one).steps
    if steps * one.pillar.block_count <= TINY and is_plain and one.record.energy:
        simulate(one)


def load(data, folder):
    """A load's file."""
    written(folder, "load.csv", data)
    try:
        history = read_history(folder / "load.csv", "stress")
    except ValueError as error:
        check(str(error))
        return "refused"
    with np.errstate(over="raise", invalid="raise"):
        history.value(np.linspace(0.0, 1.0, 10))


def curve(data, folder):
    """A file that `compare --with` names, with the place of its curve."""
    read_curves([f"{written(folder, 'curve', data)}:stress@20"], [])


def study(data, folder):
    """A study's file, and the scenes of its first points."""
    for point in load_study(str(written(folder, "study.toml", data))).points()[:3]:
        key(point)
        examine(point.scene)


def mesh(data, folder):
    """A gmsh file of a pillar of three blocks."""
    from jointwave.continuum.scene import body_of

    shape = {"pillar.length": 1.5, "pillar.side": 0.4, "pillar.block": 0.5, "soft_layers": []}
    places = {"record.stress": [0.5], "record.velocity": [0.25], "variants": []}
    file = {"numerics.continuum.mesh": str(written(folder, "pillar.msh", data))}
    body_of(cases.load_variant(FREE, "", shape | places | file))


#: What would solve something: a command that gets so far has read all that it was given.
SOLVERS = (
    "jointwave.compare.runs.run.execute",
    "jointwave.compare.runs.comparison.compare",
    "jointwave.compare.cli.studies.on_pool",
    "jointwave.compare.studies.plan.plan",
    "jointwave.compare.report.report.build",
    "jointwave.compare.runs.comparison.solved",
    "jointwave.compare.figures.animation.snapshots.take",
    "jointwave.compare.cli.explain.explanation",
    "jointwave.compare.cli.doctor.examine",
)
for name in SOLVERS:  # a module that is first imported by a command would keep what stops it
    import_module(name.rpartition(".")[0])

SOLVES = "a command would solve something"


def command(data, folder):
    """A command line, one argument a line, up to where it would solve something."""
    arguments = [os.fsdecode(part) for part in data.replace(b"\0", b"").split(b"\n")]
    said, shown = io.StringIO(), io.TextIOWrapper(io.BytesIO(), "utf-8")
    with ExitStack() as stack:
        for one in (chdir(folder), redirect_stderr(said), redirect_stdout(shown)):
            stack.enter_context(one)
        for name in SOLVERS:
            stack.enter_context(patch(name, side_effect=SceneError("here", "", None, SOLVES)))
        stack.enter_context(patch.object(sys, "argv", ["jointwave", *arguments]))
        with pytest.raises(SystemExit) as end:
            program.main()
    if end.value.code == 0:
        return "read"
    lines = [x for x in said.getvalue().splitlines() if not x.startswith("jointwave: warning")]
    check(lines[-1] if lines else "")
    assert end.value.code == 2 and lines[-1].startswith("jointwave: "), said.getvalue()[:LONGEST]
    return "read" if SOLVES in lines[-1] else "refused"


TARGETS = {target.__name__: target for target in (scene, load, curve, study, mesh, command)}

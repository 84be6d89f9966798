"""The record of a solver: what the registry knows of an engine or an exact solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple

from jointwave.cases.run_memory import waveform_bytes
from jointwave.cases.scene_type import AnyScene

if TYPE_CHECKING:
    import xarray as xr


class Rock(IntEnum):
    """The rock mass as a solver resolves it, from the coarsest to the finest."""

    ONE_BODY = 1
    HOMOGENISED = 2
    RIGID_BLOCKS = 3
    JOINTED = 4

    @property
    def words(self) -> str:
        """The rock as text."""
        joints = "with every joint"
        blocks, rock = f"rigid blocks {joints}", f"deformable rock {joints}"
        return ("one rigid body", "homogenised rock", blocks, rock)[self - 1]


class Form(IntEnum):
    """Source of a solution: an engine's run, a computation with an error bound, or a formula."""

    RUN = 1
    COMPUTED = 2
    CLOSED = 3


class Kind(IntEnum):
    """The meaning of the distance between two solvers."""

    NUMERICAL = 1
    MODELLING = 2
    BETWEEN = 3

    @property
    def words(self) -> str:
        """The meaning as text."""
        return ("numerical error", "modelling error", "between engines")[self - 1]


class Answer(NamedTuple):
    """Yes, or the reason why not; true if there is no reason."""

    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason

    @classmethod
    def unless(cls, *against: tuple[object, str]) -> Answer:
        """Return yes, or the reason of the first condition that is true."""
        return cls(next((why for there, why in against if there), ""))


LINE = 1.5  # matplotlib's default line width, points
PERIOD = 18.0  # period of the dash patterns of exact solutions, in line widths


class Line(NamedTuple):
    """A curve: colour, width in points, order (the largest on top), dash pattern in line widths,
    and marker of its samples, if any."""

    colour: str
    width: float
    order: int
    dashes: Any = "-"
    marker: str = ""

    def of_line(self) -> dict[str, Any]:
        """Return the arguments of matplotlib's plot."""
        from matplotlib import rcParams  # slow to import

        return {
            "color": self.colour,
            "linewidth": self.width * rcParams["lines.linewidth"] / LINE,
            "linestyle": self.dashes,
            "dash_capstyle": "butt",
            "zorder": 2 + self.order,
            "marker": self.marker,
            "markersize": 3.0,
            "markerfacecolor": "none",
        }


def thin(colour: str, order: int, slot: tuple[float, float]) -> Line:
    """Return the line of an exact solution: thin and dashed, above those of the engines.

    slot : its part of each dash period, so that dashes of coinciding solutions alternate.
    """
    first, last = slot
    return Line(colour, 1.1, order, (PERIOD - first, (last - first, PERIOD - (last - first))))


class Prepared(NamedTuple):
    """A run before its first step.

    scheme : of time stepping. steps : their number, 0 without any. dt, critical : time step, and
    critical step of explicit schemes, s. freedoms : of blocks or rock. bytes : of memory; for exact
    solutions at least, their waveforms. settings : that set the cost of a step.
    """

    scheme: str
    steps: int
    dt: float
    critical: float
    freedoms: int
    bytes: float
    settings: Mapping[str, Any]


def without_steps(scene: AnyScene) -> Prepared:
    """Return what is known of an exact solution before it is computed."""
    return Prepared("exact", 0, 0.0, 0.0, 0, waveform_bytes(scene), {})


@dataclass(frozen=True)
class Solver:
    """An engine or an exact solution: its model, names, line style and functions.

    rock, form : how it resolves the rock mass, and how its solution is obtained.
    label : in legends, besides its name. sentence : start of an engine's sentence in the report's
        lead.
    kinds : of scenes that it can solve: "pillar", "rock mass".
    dimension : 1 if it has no motion across the axis except a plane wave.
    in_space : whether it solves rock masses in space.
    discretised : whether an engine discretises this very model; False for solutions of a single
        mechanism, which leave out other effects of the engines.
    applies : of (scene), one of its kinds; returns whether it applies.
    run : of (scene), returns the result; for engines of (scene, progress, comm, keeper).
    prepare : of (scene), returns what is known before a run; raises SceneError like the run.
    distances : by kind, the solvers whose distance from this one is measured, with its causes.
    engine, model : as selected by --engine and --model; an engine's `engine` is also its table in
        [numerics].
    schemes : of time stepping. per_block : whether a step's cost is counted per block, else per
        degree of freedom. cost : the settings that set the cost of a step.
    shares : whether several processes can share a run. bodies_kept : returns a context in which
        runs share equal bodies, each built once; their set-up is then not that of a run alone.
    libraries : versions that affect the bits of a result, besides those of numpy and numba.
    """

    name: str
    rock: Rock
    label: str
    line: Line
    applies: Callable[[Any], Answer]
    run: Callable[..., xr.Dataset]
    form: Form = Form.COMPUTED
    kinds: tuple[str, ...] = ("pillar",)
    dimension: int = 1
    in_space: bool = False
    discretised: bool = True
    prepare: Callable[[Any], Prepared] = without_steps
    distances: Mapping[Kind, Mapping[str, str]] | None = None
    engine: str = "exact"
    model: str | None = None
    schemes: tuple[str, ...] = ()
    per_block: bool = False
    cost: tuple[str, ...] = ()
    shares: bool = False
    bodies_kept: Callable[[], AbstractContextManager[None]] = nullcontext
    libraries: Callable[[], dict[str, str]] = dict
    sentence: str = ""

    @property
    def exact(self) -> bool:
        """Whether it solves its model exactly, not by an engine's steps."""
        return self.form is not Form.RUN

    @property
    def has_rigid_blocks(self) -> bool:
        """Whether its blocks are rigid, so that it has no elements."""
        return self.rock is Rock.RIGID_BLOCKS

    @property
    def unit(self) -> str:
        """The unit in which the cost of its steps is counted."""
        return "blocks" if self.per_block else "freedoms"

    def units(self, scene: AnyScene, freedoms: int) -> int:
        """Return the number of these units in a run."""
        return freedoms // scene.block_freedoms if self.per_block else freedoms

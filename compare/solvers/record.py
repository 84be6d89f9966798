"""The record of a solver: what the registry knows of an engine or of an exact solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple

from jointwave.cases.run_memory import waveform_bytes
from jointwave.cases.scene_type import AnyScene

if TYPE_CHECKING:
    import xarray as xr


OF_BLOCK_IN_PLANE = 3  # freedoms of a rigid block of a rock mass ...
OF_BLOCK_IN_SPACE = 6  # ... and in space


class Rock(IntEnum):
    """The rock mass as a solver resolves it, from the coarsest to the finest."""

    ONE_BODY = 1
    HOMOGENISED = 2
    RIGID_BLOCKS = 3
    JOINTED = 4

    @property
    def words(self) -> str:
        """The rock in words."""
        joints = "with every joint"
        blocks, rock = f"rigid blocks {joints}", f"deformable rock {joints}"
        return ("one rigid body", "homogenised rock", blocks, rock)[self - 1]


class Form(IntEnum):
    """A solution is an engine's run, computed with a bound of its own error, or a formula."""

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
        """The meaning in words."""
        return ("numerical error", "modelling error", "between engines")[self - 1]


class Answer(NamedTuple):
    """Yes, or the reason why not; true where the solver holds."""

    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason

    @classmethod
    def unless(cls, *against: tuple[object, str]) -> Answer:
        """Return yes, or of the conditions that are met the reason beside the first."""
        return cls(next((why for there, why in against if there), ""))


LINE = 1.5  # points, of a line whose width is 1.5
PERIOD = 18.0  # of the dash patterns of exact solutions, in line widths


class Line(NamedTuple):
    """A curve: colour, width in points, its order, the largest on top, the pattern of its dashes in
    line widths, and the marker of its samples, if any."""

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
    """Return the line of an exact solution: thin and dashed, over those of the engines.

    slot : the part of each period of dashes that it fills: where all solutions coincide, their
    dashes alternate.
    """
    first, last = slot
    return Line(colour, 1.1, order, (PERIOD - first, (last - first, PERIOD - (last - first))))


class Prepared(NamedTuple):
    """A run before its first step.

    scheme : of time steps. steps : their number, 0 without any. dt, critical : the step and the
    critical step of explicit ones, s. freedoms : of the blocks or the rock. bytes : of memory, of
    solutions without steps the least, their waveforms. settings : what decides the cost of a step.
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
    """An engine or an exact solution: what it resolves, its names and its line, and its functions.

    Attributes
    ----------
    rock, form : how it resolves the rock mass, and how its solution is known.
    label : in a legend, beside its name. sentence : of an engine, how its sentence in
        the lead of the report begins.
    kinds : of scenes that it can solve: "pillar", "rock mass".
    dimension : 1 where it has no motion across the axis beside a plane wave.
    in_space : whether it solves rock masses in space.
    discretised : whether an engine discretises this very model; a solution of one mechanism alone
        leaves out what else the engines have.
    applies : of (scene), one of its kinds, to whether it holds for it.
    run : of (scene), to its result; of an engine of (scene, progress, comm, keeper).
    prepare : of (scene), to what is known before a run; raises SceneError as the run would.
    distances : by kind, the solvers whose distance from this one is measured, and what each is
        made of.
    engine, model : as --engine and --model select it; `engine` of the engines is also their table
        of [numerics].
    schemes : of time steps. per_block : whether a step's cost is counted in blocks, else in
        freedoms. cost : the settings of a run that decide what a step costs.
    shares : whether several processes can share a run.
    libraries : the versions that decide the bits of a result, beside those of numpy and numba.
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
        """What the cost of its steps is counted in."""
        return "blocks" if self.per_block else "freedoms"

    def units(self, scene: AnyScene, freedoms: int) -> int:
        """Return how many of them a run has."""
        if not self.per_block:
            return freedoms
        if scene.is_column:
            return scene.block_count
        return freedoms // (OF_BLOCK_IN_SPACE if scene.in_space else OF_BLOCK_IN_PLANE)

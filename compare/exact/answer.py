"""What a solution resolves of a scene; whether it holds for one, and if not, why."""

from enum import IntEnum
from typing import NamedTuple


class Rock(IntEnum):
    """How a solution sees the rock mass, from the coarsest to the finest."""

    ONE_BODY = 1
    HOMOGENISED = 2
    RIGID_BLOCKS = 3
    JOINTED = 4


class Form(IntEnum):
    """How a solution is known: an engine's run, computed with a bound of its own error, or a
    formula."""

    RUN = 1
    COMPUTED = 2
    CLOSED = 3


WORDS = {
    Rock.ONE_BODY: "one rigid body",
    Rock.HOMOGENISED: "homogenised rock",
    Rock.RIGID_BLOCKS: "rigid blocks with every joint",
    Rock.JOINTED: "deformable rock with every joint",
}


class Resolves(NamedTuple):
    """What a solution resolves.

    rock : how it sees the rock mass. form : how it is known. dimension : 1 where it has no motion
    across the axis beside a plane wave. discretised : whether an engine discretises this very
    model; a solution of one mechanism alone leaves out what else the engines have.
    """

    rock: Rock
    form: Form = Form.COMPUTED
    dimension: int = 1
    discretised: bool = True

    @property
    def exact(self) -> bool:
        """Whether it solves its model exactly, not by an engine's steps."""
        return self.form > Form.RUN


class Answer(NamedTuple):
    """Yes, or the reason why not; true where the solution holds."""

    yes: bool
    reason: str = ""

    def __bool__(self) -> bool:
        return self.yes


YES = Answer(True)


def no(reason: str) -> Answer:
    """Return the answer no, for this reason."""
    return Answer(False, reason)

"""Whether an exact solution holds for a scene, and if not, why."""

from typing import NamedTuple


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

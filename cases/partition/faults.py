"""Faults of a partition: where, and why."""

import numpy as np


class PartitionError(ValueError):
    """A domain that is not cut into convex blocks: where in the plane, and the cause.

    key : of what causes it, in the scene.
    """

    def __init__(self, at: np.ndarray | None, cause: str, key: str = "domain") -> None:
        place = "" if at is None else f", near [{at[0]:.6g}, {at[1]:.6g}]"
        self.at, self.cause, self.key = at, cause, key
        super().__init__(f"{cause}{place}")


class Sliver(PartitionError):
    """A block too thin or too pointed to be passed on."""


class NonConvex(PartitionError):
    """A block that is not convex, at an opening or a corner of the outline."""

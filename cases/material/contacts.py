"""Where the blocks of a pillar meet, and which of these places are no joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cases.schema.segment import regions

if TYPE_CHECKING:
    from cases.schema.scene import Scene


def contacts(scene: Scene) -> np.ndarray:
    """Return where the blocks begin and the last one ends, m [N + 1]."""
    found = [
        one.start + (one.stop - one.start) / one.blocks * np.arange(one.blocks)
        for one in regions(scene)
    ]
    return np.append(np.concatenate(found), scene.pillar.length)


def welds(scene: Scene) -> np.ndarray:
    """Return which contacts between blocks are no joints, as rock on both sides is intact, bool
    array [N - 1]."""
    intact = [i is not None and not scene.segments[i].joints for *_, i in regions(scene)]
    of_block = np.repeat(intact, [one.blocks for one in regions(scene)])
    return of_block[1:] & of_block[:-1]

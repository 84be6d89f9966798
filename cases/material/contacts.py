"""Places of the contacts between the blocks of a pillar, and those that are no joints."""

import numpy as np

from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.segment import Part

SPREAD = 3**0.5  # half the width of a uniform distribution, in standard deviations


def contacts(scene: Scene) -> np.ndarray:
    """Return where the blocks begin and the last one ends, m [N + 1]."""
    spacing, found = scene.scatter.spacing if scene.scatter else 0.0, []
    for i, one in enumerate(scene.parts):
        share = np.arange(one.blocks) / one.blocks
        if spacing and not is_intact(scene, one):
            thickness = 1 + spacing * drawn(scene, i, 0, one.blocks)
            share = np.append(0.0, np.cumsum(thickness))[:-1] / thickness.sum()
        found.append(one.start + (one.stop - one.start) * share)
    return np.append(np.concatenate(found), scene.pillar.length)


def is_intact(scene: Scene, part: Part) -> bool:
    """Return whether a part has no joints."""
    return part.segment is not None and not scene.segments[part.segment].joints


def drawn(scene: Scene, part: int, what: int, count: int) -> np.ndarray:
    """Return random numbers [count] of mean 0 and standard deviation 1, uniformly distributed.

    what : 0 for spacings, 1 for compliances; each, and each part, has a stream of its own.
    """
    assert scene.scatter is not None
    draws = np.random.default_rng([scene.scatter.seed, what, part]).random(count)
    return SPREAD * (2 * draws - 1)


def welds(scene: Scene) -> np.ndarray:
    """Return which contacts between blocks are no joints, as rock on both sides is intact, bool
    array [N - 1]."""
    intact = [is_intact(scene, one) for one in scene.parts]
    of_block = np.repeat(intact, [one.blocks for one in scene.parts])
    return of_block[1:] & of_block[:-1]

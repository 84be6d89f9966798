"""Which joints a spatial run has broken, and how fast its blocks are at the end."""

from cases.material.calibrate import Properties
from dem.fragments import with_fragments
from dem.spatial.layout import LANES, STRIDE, unpacked
from dem.spatial.model import Model, State
from results.dataset import Fields


def with_breaks(result: Fields, p: Properties, model: Model, state: State) -> Fields:
    """Return a result with its fragments, where joints soften.

    A joint is broken when all its contact points are. When it broke is not kept.
    """
    rows = model.contact.rows
    if rows.openings is None:
        return result
    opened = unpacked(state.history, LANES, p.block_count)[list(rows.openings), :-1]
    broken = (opened >= p.critical_opening).all(axis=0)
    motion, first = unpacked(state.motion, STRIDE, p.block_count), len(rows.motion) // 2
    return with_fragments(result, p, broken, motion[first : first + 3].T)

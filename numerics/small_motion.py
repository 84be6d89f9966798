"""Detection of blocks that move too far for small motion.

Contacts are those of the initial state. After a motion of a fraction s of a block, faces touch on
1 - s of the contact's area, and blocks without a contact pass through one another.
"""

from collections.abc import Callable
from math import inf
from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import StoppedError, placed
from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene

LARGEST = 0.02  # motion, over the size of the smaller block
OVERLAP = 0.01  # area, over that of the smaller block: touching corners overlap by LARGEST squared


class Moved(NamedTuple):
    """Motion `by` (m) of a block against its neighbour `other` (-1: a wall), or the depth of an
    overlap without a contact; size of the smaller block (m), and initial place, m."""

    block: int
    other: int
    by: float
    size: float
    place: tuple[float, ...]
    overlaps: bool = False


def farthest(
    pairs: np.ndarray, by: np.ndarray, size: np.ndarray, places: np.ndarray, blocks: float = inf
) -> Moved:
    """Return the contact with the largest motion over size.

    pairs : its blocks [c, 2], walls from `blocks` on. by, size : m [c]. places : m [c, d].
    """
    k = int(np.nan_to_num(by / size, nan=0.0).argmax())
    (i, j), place = pairs[k].tolist(), tuple(places[k].tolist())
    return Moved(i, j if j < blocks else -1, float(by[k]), float(size[k]), place)


def refuse_large_motion(
    scene: Scene | RockMass, who: str, find: Callable[[], Moved | None], t: float, samples: int
) -> None:
    """Raise StoppedError if a block has moved further than small motion allows.

    Only scenes of small rotations are checked: faces without rotations stand for large faces, and
    finite rotations follow faces that separate. numerics.allow_large_motion turns the check off.

    who : engine in words. find : returns the motion. t : now, s. samples : at the last check.
    """
    if scene.numerics.allow_large_motion or scene.rotation != "small":
        return
    found = find()
    if found is None or not (found.overlaps or found.by > LARGEST * found.size):
        return
    name = f"{scene.where}, {scene.name}" if scene.name else scene.where
    at = placed(found.place, 4)
    place = at if len(found.place) > 1 else f"y = {at[1:-1]}"
    wall = "a wall" if found.other < 0 else f"block {found.other + 1}"
    what = (
        f"overlaps {wall}, which it did not touch, by {found.by:.3g} m"
        if found.overlaps
        else f"has moved by {found.by:.3g} m against {wall}"
    )
    error = StoppedError(
        f"{name}: {who}: by t = {t:.4g} s block {found.block + 1} at {place} m {what}, "
        f"{found.by / found.size:.2g} of the smaller: beyond {LARGEST:g} contacts are no longer "
        "those of the start; numerics.allow_large_motion = true goes on with them"
    )
    error.samples = max(1, samples)
    raise error


def may_overlap(cut: Blocks, moved: np.ndarray) -> bool:
    """Return whether displacements [n, 2] (m) of plane blocks or their points differ enough for an
    overlap of blocks without a contact."""
    return max(map(np.ptp, moved.T)) > OVERLAP / 2 * float(np.sqrt(cut.volume.min()))


def overlapping(cut: Blocks, motion: np.ndarray) -> Moved | None:
    """Return the two plane blocks without a contact that overlap most, or None; motion : [n, 3]."""
    if not may_overlap(cut, motion[:, :2]):
        return None
    import shapely

    corners, first = cut.outlines
    owner = np.repeat(np.arange(cut.count), np.diff(first))
    arm = corners - cut.centroid[owner]
    turned = motion[owner, 2, None] * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
    moved = corners + motion[owner, :2] + turned
    blocks = np.array([shapely.Polygon(ring) for ring in np.split(moved, first[1:-1])])
    i, j = shapely.STRtree(blocks).query(blocks, predicate="intersects")
    touching = cut.contacts.blocks @ [cut.count, 1]
    new = (i < j) & ~np.isin(i * cut.count + j, touching)
    i, j = i[new], j[new]
    common = shapely.area(shapely.intersection(blocks[i], blocks[j]))
    smaller = np.minimum(cut.volume[i], cut.volume[j])
    if not (common > OVERLAP * smaller).any():
        return None
    k = int((common / smaller).argmax())
    size = float(np.sqrt(smaller[k]))
    place = tuple(cut.centroid[i[k]].tolist())
    return Moved(int(i[k]), int(j[k]), float(common[k]) / size, size, place, True)

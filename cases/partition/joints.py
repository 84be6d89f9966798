"""Joint sets of a scene as sets of planes."""

from collections.abc import Sequence
from math import cos, radians, sin

import numpy as np

from jointwave.cases.geometry.sets import PlaneSet
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.region import REST, Region

#: Cosine and sine of dips, degrees, that are exact.
EXACT = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0)}


def direction_of(dip: float) -> np.ndarray:
    """Return the unit vector [2] along joints of this dip, degrees from the horizontal."""
    exact = EXACT.get(abs(dip), (cos(radians(dip)), sin(radians(abs(dip)))))
    return np.array([exact[0], exact[1] if dip >= 0 else -exact[1]])


def plane_sets(sets: Sequence[JointSet], regions: Sequence[Region] = ()) -> list[PlaneSet]:
    """Return the planes of joint sets in a domain with some regions of rock."""
    numbers = {REST: -1, **{one.name: k for k, one in enumerate(regions)}}
    found = []
    for one in sets:
        along = direction_of(one.dip)
        found.append(
            PlaneSet(
                name=one.name,
                normal=np.array([-along[1], along[0]]),
                along=along[None],
                spacing=one.spacing,
                through=np.array(one.through if one.through is not None else [0.0, 0.0]),
                ends_at=tuple(one.ends_at),
                offset=one.offset,
                scatter=one.scatter,
                seed=one.seed,
                regions=tuple(numbers[name] for name in one.regions) if one.regions else None,
            )
        )
    return found

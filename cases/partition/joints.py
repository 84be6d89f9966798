"""Joint sets of a scene as sets of planes, and the attitude of planes."""

from collections.abc import Sequence
from math import atan2, cos, degrees, hypot, radians, sin

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


def attitude(one: JointSet | Region, dim: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit normal [d] of planes, which points up, and unit vectors in them [d - 1, d].

    In the plane these are the direction of joints, in space the strike and the line of dip.
    """
    down, up = direction_of(one.dip)
    if dim == 2:
        return np.array([-up, down]), np.array([[down, up]])
    turn = (one.dip_direction or 0.0) % 360
    north, east = direction_of(turn - 360 if turn > 180 else turn)
    along = np.array([[north, -east, 0.0], [down * east, down * north, -up]])
    return np.array([up * east, up * north, down]), along


def dips_of(normal: np.ndarray) -> dict[str, float]:
    """Return the dip, degrees, and in space the dip direction of planes with a unit normal [d]."""
    *across, up = np.array(normal) + 0.0  # no -0
    if len(across) == 1:
        return {"dip": round((degrees(atan2(-across[0], up)) + 90) % 180 - 90, 12)}
    east, north = across if up >= 0 else (-across[0], -across[1])
    dip, towards = atan2(hypot(east, north), abs(up)), atan2(east, north)
    return {"dip": round(degrees(dip), 12), "dip_direction": round(degrees(towards) % 360, 12)}


def plane_sets(
    sets: Sequence[JointSet], regions: Sequence[Region] = (), dim: int = 2
) -> list[PlaneSet]:
    """Return the planes of joint sets in a domain with some regions of rock."""
    numbers = {REST: -1, **{one.name: k for k, one in enumerate(regions)}}
    found = []
    for one in sets:
        normal, along = attitude(one, dim)
        found.append(
            PlaneSet(
                name=one.name,
                normal=normal,
                along=along,
                spacing=one.spacing,
                through=np.zeros(dim) if one.through is None else np.array(one.through),
                ends_at=tuple(one.ends_at),
                offset=one.offset,
                scatter=one.scatter,
                seed=one.seed,
                regions=tuple(numbers[name] for name in one.regions) if one.regions else None,
            )
        )
    return found

"""What the contact points of a face add up to in each of a block's six freedoms."""

from typing import NamedTuple

import numpy as np

from cases.face import face_points
from cases.schema.scene import Scene
from dem.spatial.contact import Points, Section


class Face(NamedTuple):
    """The shares of a unit normal and a unit shear stiffness (Pa/m), or dashpot, in the freedoms
    x, y, z, about x, y, z of a face: float arrays [6], m2 and m4."""

    normal: np.ndarray
    shear: np.ndarray

    def spread(self, normal: float, shear: float, size: int) -> np.ndarray:
        """Return what normal and shear springs or dashpots make of the first `size` freedoms."""
        return (normal * self.normal + shear * self.shear)[:size]


def contact_points(scene: Scene) -> Points:
    """Return the contact points of a scene's faces; the centre alone where blocks do not turn."""
    if scene.motion.rotation == "none":
        return Points((0.0,), (0.0,), (scene.pillar.area,))
    joints = scene.joints
    x, z, area = face_points(
        scene.pillar.side, joints.contact_points or 2, joints.point_rule or "midpoint"
    )
    return Points(tuple(x.tolist()), tuple(z.tolist()), tuple(area.tolist()))


def section(points: Points) -> Section:
    """Return the sums over the points of a face."""
    x, area = np.array(points.x), np.array(points.area)
    across = float((area * x**2).sum())
    return Section(float(area.sum()), across, 2 * across)


def face_of(section: Section) -> Face:
    """Return the shares of a face's springs in each freedom."""
    a, across, along = section
    return Face(np.array([0, a, 0, across, 0, across]), np.array([a, 0, a, 0, along, 0]))

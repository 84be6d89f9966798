"""Contact points of a square face, as Guo & Li (2002), (2), have them, and by the other rules."""

import numpy as np

from jointwave.cases.material.contact_points import points_of


def face_points(
    side: float, count: int | None, rule: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x (m), z (m) and area (m2) of the contact points of a square face, each [points].
    midpoint, n = 2: as in Guo & Li (2002), (2). All rules are symmetric to the last bit."""
    if rule == "vertices":
        x, z = side / 2 * np.array([[-1, -1, 1, 1, 0], [-1, 1, -1, 1, 0]])
        return x, z, side**2 / 12 * np.array([1.0, 1.0, 1.0, 1.0, 8.0])
    at, share = points_of(rule, count)
    at, share = side * (at - at[::-1]) / 2, side * (share + share[::-1]) / 2
    x, z = np.meshgrid(at, at, indexing="ij")
    return x.ravel(), z.ravel(), np.outer(share, share).ravel()

"""Contact points of the faces of blocks, in the plane and in space."""

import numpy as np
import pytest

from jointwave.dem.prepare import prepared
from tests.rocks import rock

ASKEW = [{"dip": 15.0, "dip_direction": 40.0}, {"dip": 80.0, "dip_direction": 100.0}]
ASKEW += [{"dip": 60.0, "dip_direction": 200.0}]
ATTITUDES = {2: [{"dip": dip} for dip in (20.0, 75.0, 140.0)], 3: ASKEW}


def blocks_of(dim, rule):
    """Return blocks between joints without tension, on a fixed bottom, most askew to the sides."""
    law = {"spacing": 1.3, "through": [1.3] * dim, "tension": False}
    size = [5.2, 2.6, 3.9][:dim]
    domain = {"size": size, "slivers": "merge", "least_width": 0.03}
    held = {"boundaries": {"bottom": "fixed"}, "gravity": {}}
    return prepared(rock(size, ATTITUDES[dim], law | rule, domain=domain, **held)).blocks


@pytest.mark.parametrize("rule", [{}, {"point_rule": "gauss"}], ids=["vertices", "gauss"])
@pytest.mark.parametrize("dim", [2, 3])
def test_points_have_the_moments_of_faces(dim, rule):
    """Area, centroid and second moments of all faces, those of the fixed side too, with no weight
    below zero; polygons of some sides in space."""
    blocks = blocks_of(dim, rule)
    met, places, area = blocks.contacts, blocks.points[..., :-1], blocks.points[..., -1]
    size = np.sqrt(np.trace(met.spread, axis1=1, axis2=2))
    assert (area >= 0).all() and len(set(np.diff(met.outlines.first))) == (4 if dim == 3 else 1)
    np.testing.assert_allclose(area.sum(axis=1), met.area, rtol=1e-12)
    first = (area[..., None] * places).sum(axis=1) / (met.area * size)[:, None]
    np.testing.assert_allclose(first, 0, atol=1e-10)
    second = places.swapaxes(1, 2) @ (area[..., None] * places) / met.area[:, None, None]
    scale = size[:, None, None] ** 2
    np.testing.assert_allclose(second / scale, met.spread / scale, rtol=0, atol=1e-9)

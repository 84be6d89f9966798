"""A pillar from a file of the user's is the pillar that is built."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum.build import mesh_of
from jointwave.continuum.space.kinematics import kinematics

BLOW = {
    2: {"load__direction": [0.6, 0.8, 0.0], "load__at": [0.1, 0.0]},
    3: {"load__direction": [0.48, 0.6, -0.64], "load__at": [0.1, -0.05]},
}
ACTING = {
    "joints": {"friction_angle": 20.0, "cohesion": 1e4, "tension": False, "damping_ratio": 0.02},
    "ends": {"start": "quiet", "end": "matched"},
}


@pytest.mark.parametrize(
    ("dim", "cell"), [(2, "hexahedron"), (2, "simplex"), (3, "hexahedron"), (3, "simplex")]
)
def test_exported_pillar_reads_back_and_moves_alike(dim, cell, short, ready, exported):
    """Blocks that stand once instead of copies of one: other numbers, the same motion to 1e-10 of
    the largest, with every joint sliding and opening."""
    across = {"numerics__continuum__elements_across": 2, "numerics__continuum__cell": cell}
    built = short(**BLOW[dim], **ACTING, **across)
    path = exported(mesh_of(built, calibrate(built), "jointed", kinematics(built, dim)))
    given = short(**BLOW[dim], **ACTING, numerics__continuum__mesh=str(path))
    one, other = (ready(scene, "jointed", dim, samples=201) for scene in (built, given))
    assert len(other.discrete.body.mesh.parts) == 4 > len(one.discrete.body.mesh.parts)
    assert other.time.dt == pytest.approx(one.time.dt, rel=1e-4)
    other = ready(given, "jointed", dim, clock=one.time)
    waves = one.to_the_end().waves
    for name, expected in other.to_the_end().waves.items():
        peak = np.abs(expected).max()
        assert np.abs(waves[name] - expected).max() < 1e-10 * peak > 0, name
    assert other.samples.energy == pytest.approx(one.samples.energy, rel=1e-9, abs=1e-9)

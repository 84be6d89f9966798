"""Plane waves at one joint in space by both engines, against the exact solution."""

import numpy as np
import pytest

import jointwave
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit

#: Angle from the joint's normal and azimuth, degrees, and how the wave moves rock: along its travel
#: (P), in its plane of incidence (SV), across it (SH) or between both.
WAVES = {
    "P": (20.0, 37.0, None),
    "SV": (20.0, 110.0, (1.0, 0.0)),
    "SH at 20": (20.0, 37.0, (0.0, 1.0)),
    "SH at 45": (45.0, 110.0, (0.0, 1.0)),
    "S of both": (30.0, 110.0, (0.6, 0.8)),
}
#: Largest misfit: the stated accuracy of the continuum, and of five rigid blocks a side: at some 17
#: blocks a wavelength of S they disperse it, in the worst component, and have no Poisson effect.
BOUNDS = {"continuum-jointed": 0.005, "dem": 0.4}


@pytest.mark.parametrize("engine", BOUNDS)
@pytest.mark.parametrize("wave", WAVES)
def test_engines_have_the_waves_of_one_joint(engine, wave):
    angle, azimuth, moves = WAVES[wave]
    phi, turn = np.radians([angle, azimuth])
    t, up = np.array([np.sin(turn), np.cos(turn), 0.0]), np.array([0.0, 0.0, 1.0])
    changes = {"waves.0.direction": (np.sin(phi) * t + np.cos(phi) * up).tolist()}
    if moves:
        axes = np.array([np.cos(phi) * t - np.sin(phi) * up, np.cross(t, up)])
        changes |= {"waves.0.kind": "S", "waves.0.polarisation": (np.array(moves) @ axes).tolist()}
    scene = jointwave.load("rock-mass/joint-in-space", changes=changes)
    assert misfit(solve(engine, scene), solve("oblique-joint", scene)) < BOUNDS[engine]

"""A free pillar keeps its momentum and angular momentum, and a mirrored one moves mirrored."""

import numpy as np
import pytest

from jointwave.cases.loads import load_history

JOINTS = {
    "elastic": {},
    "slip": {"joints": {"friction_angle": 20.0, "cohesion": 1e4}},
    "no tension": {"joints": {"tension": False}},
}
WAYS = {2: ([0.6, 0.8, 0.0], [0.1, 0.0]), 3: ([0.48, 0.6, -0.64], [0.1, -0.05])}


def blow(dim: int, shape: str = "step", **changes) -> dict:
    """Return an oblique eccentric load, in the plane or in space."""
    way, at = WAYS[dim]
    period = {"period": 1e-3} if shape == "sine" else {}
    return {"shape": shape, "amplitude": 1e5, "direction": way, "at": at, **period, **changes}


def momenta(run) -> tuple[np.ndarray, np.ndarray]:
    """Return momentum (N s) and angular momentum about the centre of the start face (N m s).

    Of small displacements: the lever of a node is its unloaded place.
    """
    body, dim = run.discrete.body, run.discrete.body.dim
    push, arms = np.zeros((len(body.x), 3)), np.zeros((len(body.x), 3))
    arms[:, :dim] = body.x
    for c in range(dim):
        freedom = body.freedom(np.arange(len(body.x)), c)
        push[:, c] = body.mass[freedom] * run.state.v[freedom]
    return push.sum(axis=0), np.cross(arms, push).sum(axis=0)


@pytest.mark.parametrize(
    ("dim", "cell", "joints"),
    [(2, "hexahedron", kind) for kind in JOINTS]
    + [(3, "hexahedron", kind) for kind in JOINTS]
    + [(2, "simplex", "slip"), (3, "simplex", "slip")],
)
def test_momenta_are_the_impulse_of_the_load(plain, dim, cell, joints, short, ready):
    """Of a step load up to half a step before the last, whatever the joints do: their tractions
    act at one place on both sides. To 1e-11 of the largest."""
    scene = short(load=blow(dim), numerics__continuum__cell=cell, **JOINTS[joints])
    run = ready(scene, "jointed", dim, samples=101).take(0, 100)
    impulse = 0.25 * load_history(scene).impulse(run.time.dt * 99.5)
    push, at = impulse * np.array(scene.load.direction), scene.load.at
    linear, angular = momenta(run)
    turn = np.cross([at[0], 0.0, at[1]], push)
    assert np.abs(linear - push).max() < 1e-11 * np.abs(push).max()
    assert np.abs(angular - turn).max() < 1e-11 * np.abs(turn).max()


@pytest.mark.parametrize("mirror", [0, 2], ids=["x", "z"])
@pytest.mark.parametrize("joints", JOINTS)
def test_mirrored_blow_gives_the_mirrored_motion(plain, joints, mirror, short, ready):
    """x to -x: the displacement along x and the turns about y and z change their signs; z alike."""
    way, at = (np.array(values) for values in WAYS[3])
    other_way, other_at = way.copy(), at.copy()
    other_way[mirror] *= -1
    other_at[mirror // 2] *= -1
    mirrored = {"direction": other_way.tolist(), "at": other_at.tolist()}
    one, other = (
        ready(short(load=blow(3, "sine", **changes), **JOINTS[joints]), "jointed", 3, samples=101)
        .to_the_end()
        .waves
        for changes in ({}, mirrored)
    )
    signs = np.ones(3)
    signs[mirror] = -1
    alike(other["stress"], one["stress"])
    alike(other["shear"], one["shear"] * signs[[0, 2]])
    alike(other["velocity"], one["velocity"] * signs)
    alike(other["rotation"], -one["rotation"] * signs)


def alike(found: np.ndarray, expected: np.ndarray) -> None:
    """Assert that waves are the same but for round-off, and that there are any."""
    peak = np.abs(expected).max()
    assert peak > 0
    assert np.abs(found - expected).max() < 1e-10 * peak

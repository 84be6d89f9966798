"""Dynamic relaxation: how fast it comes to rest, and that it ends where it must."""

import numpy as np
import pytest
from scipy.linalg import eigvalsh_tridiagonal

from cases.material.calibrate import calibrate
from dem.axial.build import build
from dem.axial.start import ChainRelaxation
from dem.static import relax

TOLERANCE = 1e-8
CHAINS = {
    "one fixed end": {"ends__end": "fixed"},
    "two fixed ends": {
        "ends": {"start": "fixed", "end": "fixed"},
        "load": {"shape": "step", "amplitude": 0.0},
    },
    "soft layer": {
        "ends__end": "fixed",
        "soft_layers": [{"y": 20.0, "spacing_stiffness": 4e8}],
    },
    "four times as long": {"ends__end": "fixed", "pillar__length": 200.0},
    "dashpots left out": {"ends__end": "fixed", "joints__damping_ratio": 0.5},
}


def relaxation(scene):
    """Return the relaxation of a scene's pillar from its unloaded state."""
    _, state, _, _ = build(scene)
    return ChainRelaxation(scene, calibrate(scene), state, weighed=True)


def slowest(system):
    """Return the lowest natural frequency (rad/s) of what is relaxed."""
    k, ends = system.stiffness, (system.chain.start, system.chain.end)
    diagonal = np.append(k, 0.0) + np.append(0.0, k)
    diagonal[[0, -1]] += [end.stiffness for end in ends]
    return np.sqrt(eigvalsh_tridiagonal(diagonal, -k)[0] / system.mass[0])


@pytest.mark.parametrize("changes", CHAINS.values(), ids=CHAINS)
def test_steps_are_those_of_critical_damping(pillar, changes):
    """At critical damping of its slowest mode exp(-omega t) falls to the tolerance; within 15 %."""
    system = relaxation(pillar(gravity={"direction": [0, 1, 0]}, **changes))
    rest = relax(system, TOLERANCE, system.most_steps)
    expected = np.log(1 / TOLERANCE) / (slowest(system) * system.chain.dt)
    assert rest.ratio <= TOLERANCE
    assert rest.steps < 1.15 * expected


@pytest.mark.parametrize("changes", CHAINS.values(), ids=CHAINS)
def test_it_ends_in_the_elastic_state(pillar, changes):
    """Contact forces are those of the direct solution within the tolerance times the blocks."""
    system = relaxation(pillar(gravity={"direction": [0, 1, 0]}, **changes))
    relax(system, TOLERANCE, system.most_steps)
    forces = system.elastic_forces(system.chain.weight)
    gaps = -forces[1:-1] / system.stiffness
    error = np.abs(np.diff(system.state.u) - gaps) * system.stiffness
    assert error.max() < TOLERANCE * system.scale * len(system.mass)
    assert not system.state.v.any()


def test_barred_tension_is_found_between_two_fixed_ends(pillar):
    """What would hang from the upper wall lies on the lower: each joint carries the weight above.

    The first block alone stays on the wall's spring.
    """
    held = {"ends": {"start": "fixed", "end": "fixed"}, "joints__tension": False}
    scene = pillar(
        gravity={"direction": [0, 1, 0]}, load={"shape": "step", "amplitude": 0.0}, **held
    )
    system = relaxation(scene)
    rest = relax(system, TOLERANCE, system.most_steps)
    weight = system.chain.weight * np.arange(1, len(system.mass))
    forces = system.stiffness * np.maximum(-np.diff(system.state.u), 0.0)
    assert rest.ratio <= TOLERANCE
    assert np.abs(forces + system.chain.weight - weight)[1:].max() < 1e-5 * system.scale
    assert forces[0] == 0.0


def test_a_stall_is_noticed_long_before_the_last_step(pillar):
    """A pillar without tension cannot hang: the weight of a block stays unbalanced."""
    scene = pillar(gravity={"direction": [0, -1, 0]}, ends__end="fixed", joints__tension=False)
    system = relaxation(scene)
    rest = relax(system, TOLERANCE, system.most_steps)
    assert rest.steps < 0.1 * system.most_steps
    assert rest.ratio == pytest.approx(1 / len(system.mass), rel=0.5)

"""Lattices and brickwork between periodic sides, in the plane and in space, against their assembled
equations.

A Bloch wave of the infinite lattice with frequency omega, and a mode of bricks, step on at Omega,
sin(Omega dt / 2) = omega dt / 2, so that the kernel is held to round-off in all its branches."""

import numpy as np
import pytest

from closed_forms.bloch import leapfrog, modes, periodic
from jointwave.cases.partition.scene import blocks_of_domain
from jointwave.cases.schema.domain import Domain
from jointwave.dem.kernel.leapfrog import march
from jointwave.dem.kernel.model import samples_for, state_at_rest
from jointwave.dem.prepare import prepared
from tests.rocks import rock

SIDE, DENSITY, STIFFNESS = 2.0, 2500.0, (3e9, 1.1e9)  # m, kg/m3; normal and in shear, Pa/m
COUNT = {2: 12, 3: 6}
#: Normals of joints: up, to the east and to the north.
ATTITUDES = {"dip": 0.0}, {"dip": 90.0, "dip_direction": 90.0}, {"dip": 90.0, "dip_direction": 0.0}
POINTS = {"friction_angle": 30.0, "cohesion": 1e20, "point_rule": "gauss", "contact_points": 2}
ACROSS = (("left", "right"), ("bottom", "top"), ("front", "back"))


def system_of(size, laws, pairs):
    """Return blocks of these joints up, to the east and to the north between pairs of periodic
    sides, in rock so stiff that joints have their own stiffness."""
    dim, sets = len(size), [one | law for one, law in zip(ATTITUDES, laws, strict=False)]
    if dim == 2:
        sets = [{k: v for k, v in one.items() if k != "dip_direction"} for one in sets]
    tables = {
        "rock": {"density": DENSITY, "intact_modulus": 1e25, "intact_poisson": 0.2},
        "boundaries": dict.fromkeys(sum(pairs, ()), "periodic"),
        "time": {"duration": 1.0},
        "record": {"points": [[x / 2.1 for x in size]], "interval": 1.0},
    }
    return prepared(rock(size, sets, {"through": [0.0] * dim}, **tables))


def law_of(name, stiffness, **keys):
    normal, shear = stiffness
    return {"name": name, "normal_stiffness": normal, "shear_stiffness": shear} | keys


def steps_on(system, motion, steps):
    """Hold blocks to a motion, a function of time of the size 1, to 1e-10 of it after steps."""
    model, dt = system.model, system.time.dt
    state = state_at_rest(model)
    state.u[:], state.v[:] = motion(0.0), (motion(0.0) - motion(-dt)) / dt
    march(model, state, samples_for(model, 0), 2 * steps, (1, 1 + steps))
    np.testing.assert_allclose(state.u, motion(steps * dt), rtol=0, atol=1e-10)


@pytest.mark.parametrize("rule", [{}, POINTS], ids=["faces", "points"])
@pytest.mark.parametrize("waves", [[1, 0], [2, 3], [1, 0, 0], [1, 2, 1]])
def test_bloch_waves_step_on_as_leapfrog_has_them(waves, rule):
    """All branches of a lattice keep their form over 5,000 steps, with points too."""
    dim = len(waves)
    laws = [law_of(str(k), STIFFNESS, spacing=SIDE, **rule) for k in range(dim)]
    system = system_of([SIDE * COUNT[dim]] * dim, laws, ACROSS[:dim])
    assert system.model.form.points == (rule is POINTS)
    one = blocks_of_domain(Domain(size=[SIDE] * dim), [])
    k = 2 * np.pi * np.array(waves) / COUNT[dim] / SIDE
    frequencies, motions = modes(periodic(one, DENSITY, [STIFFNESS], [], range(dim)), k)
    phase = np.exp(1j * system.blocks.cut.centroid @ k)[:, None]
    for omega, motion in zip(frequencies, motions.T, strict=True):
        stepped, shape = leapfrog(omega, system.time.dt), phase * motion / np.abs(motion).max()

        def at(time, shape=shape, stepped=stepped):
            return (shape * np.exp(-1j * stepped * time)).real

        steps_on(system, at, 5000)


BED, HEAD = (2e10, 8e9), (1e10, 5e9)


@pytest.mark.parametrize("rule", [{"point_rule": "midpoint", "contact_points": 3}, {}])
@pytest.mark.parametrize("dim", [2, 3])
def test_modes_of_running_bond_stand(dim, rule):
    """Bricks of 0.6 m (by 0.5 m) by 0.3 m, whose sides repeat but at the free ends of the wall:
    from the slowest that is no rigid motion to the fastest. Three midpoints carry 8/9 of the
    bending stiffness."""
    bond = {"spacing": 0.6, "ends_at": ["bed"], "offset": 0.5}
    laws = [law_of("bed", BED, spacing=0.3), law_of("head", HEAD, **bond)]
    laws.append(law_of("collar", BED, spacing=0.5))
    laws = [one | rule for one in laws[:dim]]
    system = system_of([1.8, *[1.0] * (dim - 2), 1.2], laws, ACROSS[1:dim])
    springs, cut = np.array([BED, HEAD, BED][:dim]), system.blocks.cut
    names = [one["name"] for one in laws]
    cell = periodic(cut, DENSITY, springs, names, range(1, dim), 8 / 9 if rule else 1.0)
    omega, shapes = modes(cell, np.zeros(dim))
    assert (omega[:dim] < 1e-6 * omega[-1]).all() and omega[dim] > 1e-3 * omega[-1]
    for k in (dim, dim + 1, len(omega) // 3, len(omega) // 2, len(omega) - 1):
        shape = shapes[:, k].real.reshape(cut.count, -1)
        shape, stepped = shape / np.abs(shape).max(), leapfrog(omega[k], system.time.dt)
        steps_on(system, lambda t, shape=shape, w=stepped: shape * np.cos(w * t), 2000)

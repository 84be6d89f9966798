"""Scenes of rigid blocks exactly in time: a column that is a chain, and the engine's steps."""

import numpy as np
import pytest

from jointwave.cases.histories import Ricker
from jointwave.compare.engines import solve
from jointwave.compare.exact.linear import twins

LAW = {"normal_stiffness": 4e10, "shear_stiffness": 2e10}


#: Of each dimension: the joint sets as name, dip, dip direction and spacing, the domain, an oblique
#: direction, and points in the first, the seventh and the last block of a column.
SETS = {
    2: [("bed", 0.0, None, 0.5), ("cross", 90.0, None, 1.0)],
    3: [("bed", 0.0, None, 0.5), ("head", 90.0, 90.0, 1.0), ("wall", 90.0, 0.0, 0.75)],
}
SIZE = {2: [3.0, 6.0], 3: [3.0, 1.5, 6.0]}
SLANT = {2: [0.28, 0.96], 3: [0.28, 0.576, 0.768]}
PERIODIC = dict.fromkeys(("left", "right", "front", "back"), "periodic")


@pytest.fixture(params=[2, 3], ids=["plane", "space"])
def dim(request):
    return request.param


@pytest.fixture
def blocks(rock_mass, joint, wave, dim):
    """Blocks of 1 m by 0.5 m in 3 m by 6 m, in space 0.75 m and 1.5 m wide, and tables changed."""
    sets = [
        joint(**LAW, name=name, dip=dip, spacing=spacing, through=[0.0] * dim)
        | ({} if towards is None else {"dip_direction": towards})
        for name, dip, towards, spacing in SETS[dim]
    ]
    across = [0.4] * (dim - 2)
    record = [[1.5, *across, 0.25], [0.5, *across, 3.25], [1.5, *across, 5.75]]
    tables = {
        "joint_sets": sets,
        "domain": {"size": SIZE[dim]},
        "time": {"duration": 0.02},
        "waves": [wave(direction=[0.0] * (dim - 1) + [1.0])],
        "record": {"points": record, "joints": []},
    }
    sides = {} if dim == 2 else {"boundaries": {"front": "quiet", "back": "quiet"}}
    return lambda **changes: rock_mass(**{**tables, **sides, **changes})


def test_a_column_under_a_p_wave_is_the_chain(blocks, dim):
    """12 blocks in a row with K' = 1 / (1/K + h/M) between them, M = 6e10 Pa, and dashpots rho c at
    both ends. rho c^2 = C_zz of the medium: the inverse of the rock's compliance (lambda = 2e10 Pa)
    with 1/(spacing K) along each axis. The wave of 1 MPa pushes the lowest with twice its stress;
    the dashpot above takes it in."""
    scene = blocks(
        boundaries={k: v for k, v in PERIODIC.items() if dim == 3 or k in ("left", "right")}
    )
    M, h, K, count = 6e10, 0.5, 4e10, 12
    rock = np.full((dim, dim), 2e10) + 4e10 * np.eye(dim)
    spacings = [1.0, *[0.75] * (dim - 2), h]
    compliance = np.linalg.inv(rock) + np.diag([1 / (x * K) for x in spacings])
    mass, Z, scale = 2500 * h, np.sqrt(2500 * np.linalg.inv(compliance)[-1, -1]), 1e4
    spring = 1 / (1 / K + h / M)
    L = 2 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    L[0, 0] = L[-1, -1] = 1
    A = np.zeros((2 * count, 2 * count))
    A[:count, count:] = scale * np.eye(count)
    A[count:, :count] = -spring * L / mass / scale
    A[count, count] = A[-1, -1] = -Z / mass
    b = np.zeros(2 * count)
    b[count] = 2 / mass
    found = solve("block-lattice", scene)
    states = twins(A, b, Ricker(1e6, 0.005), found.time.values)[0]
    states[:, :count] /= scale
    for point, block in enumerate((0, 6, 11)):
        for name, column in (("displacement", block), ("velocity", count + block)):
            expected, bound = states[:, column], found[f"{name}_error"][point, -1]
            off = found[name][point, :, -1] - expected
            assert np.sqrt(np.mean(off**2)) <= bound < 1e-7 * np.abs(expected).max()
        assert np.abs(found.velocity[point, :, :-1]).max() < 1e-12


@pytest.mark.parametrize("dip", [0.0, 20.0])
def test_steps_of_the_engine_come_to_it_at_the_second_order(blocks, wave, dim, dip):
    """An oblique wave on boxes, and on blocks whose principal axes are oblique, with quiet sides
    all around: leapfrog is off by the square of its step, in velocity and in displacement."""
    off, steps = [], []
    bed, *others = blocks().joint_sets
    bed = bed.model_copy(update={"dip": dip, "dip_direction": 40.0 if dim == 3 else None})
    sets = [one.model_dump(exclude_none=True) for one in (bed, *others)]
    waves = [wave(direction=SLANT[dim])]
    tables = {"waves": waves, "joint_sets": sets, "time": {"duration": 0.01}}
    exact = solve("block-lattice", blocks(**tables))
    for fraction in (0.4, 0.1):
        found = solve("dem", blocks(**tables, numerics={"dem": {"step_fraction": fraction}}))
        steps.append(found.attrs["dt"])
        worst = abs(found - exact).max() / abs(exact).max()
        off.append([worst[name].item() for name in ("velocity", "displacement")])
    rate = np.log(np.divide(*off)) / np.log(steps[0] / steps[1])
    assert rate == pytest.approx(2, abs=0.1) and max(off[1]) < 2e-4

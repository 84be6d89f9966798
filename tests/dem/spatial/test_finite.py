"""Finite rotations: momentum is conserved, a free top is exact, small ones are the limit."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jointwave import dem
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Clock
from jointwave.dem.spatial.build import buffers_for, build_model, samples_for, state_at_rest
from jointwave.dem.spatial.layout import LANES, STRIDE
from jointwave.dem.spatial.march import make_stepper
from jointwave.results.dataset import energy_residual

DT = 2e-5
BLOW = {
    "pillar__length": 5.0,
    "load__direction": [0.6, 0.8, 0.0],
    "load__at": [0.1, 0.05],
    "record__stress": [1.0, 2.5],
    "record__velocity": [0.3, 2.0],
    "time__duration": 0.02,
    "motion__rotation": "finite",
}
LOOSE = {**BLOW, "joints__tension": False, "joints__friction_angle": 30.0}


class Row:
    """A row of blocks that turn by any angle, with its state by block."""

    def __init__(self, scene):
        self.p = calibrate(scene)
        model = build_model(scene, self.p, Clock(DT, 1, 1))
        still = model.load._replace(stress=np.zeros(0))
        form = model.form._replace(ledger=False)
        self.model = model._replace(load=still, form=form, stride=1 << 40)
        self.state = state_at_rest(self.model)
        self.rows = self.state.motion.reshape(len(self.state.motion), -1, STRIDE)[:, :, :LANES]
        self.march = make_stepper(
            self.model, self.state, buffers_for(self.model, 1), samples_for(self.model, 1)
        )
        self.y = self.p.spacing * (np.arange(self.p.block_count) + 0.5)

    def part(self, first, count=3):
        """Return rows first .. of every block, [blocks, count], as a view of the one tile."""
        return self.rows[0, first : first + count, : self.p.block_count].T

    def places(self):
        return self.part(0) + np.stack([0 * self.y, self.y, 0 * self.y], axis=1)

    def orientation(self):
        return Rotation.from_quat(np.concatenate([self.part(3), self.part(12, 1)], axis=1))

    def turn(self, rotation):
        """Turn the whole row about the origin, with its motion."""
        places, turned = self.places(), rotation * self.orientation()
        self.part(0)[:] += rotation.apply(places) - places
        quaternions = turned.as_quat()
        self.part(3)[:], self.part(12, 1)[:] = quaternions[:, :3], quaternions[:, 3:]
        for first in (6, 9):
            self.part(first)[:] = rotation.apply(self.part(first))

    def momenta(self):
        """Return momentum and angular momentum about the origin, with places at the whole step."""
        p = self.p.block_mass * self.part(6)
        return p.sum(axis=0), (np.cross(self.places(), p) + self.part(9)).sum(axis=0)


def set_moving(row, seed=1):
    """Give every block a velocity and an angular momentum of its own."""
    random = np.random.default_rng(seed)
    row.part(6)[:] = 0.1 * random.standard_normal((row.p.block_count, 3))
    row.part(9)[:] = row.p.inertia_across * random.standard_normal((row.p.block_count, 3))


def test_free_block_is_the_symmetric_top(pillar):
    """Far from its neighbours a block turns about L by L t / I_t, and about its own axis.

    Exact for any step; 5000 steps leave the round-off of as many quaternion products, below 1e-12.
    """
    row = Row(pillar(**LOOSE))
    row.part(0)[:, 1] += 5.0 * np.arange(row.p.block_count)  # all apart
    momentum = np.array([3.0, -2.0, 4.0]) * row.p.inertia_across
    row.part(9)[3] = momentum
    row.march(1, 5001)
    across, along = row.p.inertia_across, row.p.inertia_along
    own = (1 / along - 1 / across) * momentum[1]  # the axis is y at first, so L_y stays along it
    time = 5000 * DT
    exact = Rotation.from_rotvec(time * momentum / across) * Rotation.from_rotvec(
        [0, time * own, 0]
    )
    assert (exact.inv() * row.orientation()[3]).magnitude() < 1e-12
    assert (row.part(9)[3] == momentum).all()


@pytest.mark.parametrize("changes", [BLOW, LOOSE], ids=["elastic", "no tension, friction"])
def test_momentum_and_angular_momentum_are_conserved(pillar, changes):
    """Both forces of a joint act at one place: 2000 steps change neither sum but by round-off.

    Each step adds round-off of the momenta exchanged, some 1e-16 of their sizes.
    """
    row = Row(pillar(**changes))
    set_moving(row)
    before = row.momenta()
    size = np.abs(row.p.block_mass * row.part(6)).sum() * row.y[-1]
    row.march(1, 2001)
    assert np.abs(row.part(3)).max() > 1e-3  # they have turned
    for old, new in zip(before, row.momenta(), strict=True):
        assert np.abs(new - old).max() < 1e-12 * size


def test_a_turned_row_moves_as_the_row_turned(pillar):
    """Space has no direction: turning first or afterwards gives the same to round-off, grown by
    the row's own stiffness: 1e-16 of 5 m over closures of 1e-4 m is 5e-12 a step's force."""
    rotation = Rotation.from_rotvec([0.7, -1.9, 0.4])
    first, after = Row(pillar(**LOOSE)), Row(pillar(**LOOSE))
    set_moving(first)
    set_moving(after)
    first.turn(rotation)
    first.march(1, 301)
    after.march(1, 301)
    after.turn(rotation)
    np.testing.assert_allclose(first.places(), after.places(), atol=1e-10)
    np.testing.assert_allclose(first.part(6), after.part(6), atol=1e-8)
    assert (first.orientation().inv() * after.orientation()).magnitude().max() < 1e-9


def test_small_rotations_are_the_limit(pillar):
    """What small rotations neglect is quadratic in the amplitude: its share is linear in it."""

    def share(amplitude):
        changes = {**BLOW, "load__amplitude": amplitude, "joints__damping_ratio": 0.02}
        finite = dem.simulate(pillar(**changes))
        small = dem.simulate(pillar(**{**changes, "motion__rotation": "small"}))
        found = []
        for name in ("stress", "shear", "velocity", "displacement", "rotation"):
            a, b = finite[name].values, small[name].values
            found.append(np.abs(a - b).max() / np.abs(b).max())
        return np.array(found)

    weak, strong = share(1e3), share(1e5)
    assert (weak < 1e-4).all()
    np.testing.assert_allclose(strong / weak, 100, rtol=0.05)


def test_ledger_closes_to_second_order(pillar):
    """Rotation is not leapfrog's quadratic form: what stays open falls with the square of dt."""

    def residual(fraction):
        changes = {**BLOW, "load__amplitude": 1e7, "joints__damping_ratio": 0.02}
        return energy_residual(
            dem.simulate(pillar(**changes, numerics__dem__step_fraction=fraction))
        )

    coarse, fine = residual(0.2), residual(0.05)
    assert fine < 1e-4
    assert coarse / fine > 8


def incline(pillar, slope):
    """Return the largest rotation of a loose block on a rough slope after one second."""
    angle = np.arctan(slope)
    scene = pillar(
        pillar__length=1.0,
        pillar__block=0.5,
        joints={"tension": False, "friction_angle": 60.0, "damping_ratio": 0.3},
        load={"shape": "step", "amplitude": 0.0},
        gravity={"direction": [np.sin(angle), np.cos(angle), 0.0], "static": False},
        ends__end="fixed",
        motion__rotation="finite",
        time__duration=1.0,
        record={"velocity": [0.25], "interval": 0.01},
        numerics__dem__step_fraction=0.3,
    )
    return np.abs(dem.simulate(scene).rotation.values).max()


def test_a_block_topples_where_its_weight_leaves_its_base(pillar):
    """Cube on 2 x 2 midpoints at a quarter of the side: the edge of its base is d/4 from the
    centre, its centroid d/2 above, so it topples beyond tan(slope) = 1/2 and not before."""
    assert incline(pillar, 0.46) < 1e-3
    assert incline(pillar, 0.54) > 0.3


def test_a_row_without_points_has_no_rotations(pillar):
    found = dem.simulate(pillar(**(BLOW | {"record__velocity": []})))
    assert found.rotation.shape == (0, found.sizes["time"], 3)

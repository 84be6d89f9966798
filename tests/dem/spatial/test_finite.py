"""Finite rotations: momentum is conserved, a free top is exact, small ones are the limit."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jointwave import dem
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.results.dataset import energy_residual

BLOW = {
    "pillar__length": 5.0,
    "load__direction": [0.6, 0.8, 0.0],
    "load__at": [0.1, 0.05],
    "record__stress": [1.0, 2.5],
    "record__velocity": [0.3, 2.0],
    "time__duration": 0.02,
    "motion__rotation": "finite",
}
LOOSE = {"joints__tension": False, "joints__friction_angle": 30.0}
PUSH = {"shape": "triangle", "amplitude": 1e7, "rise": 2e-3, "decay": 2e-3}


def orientations(result):
    """Return the orientation of every recorded block at each sample, [sample][block]."""
    return [Rotation.from_rotvec(one) for one in np.moveaxis(result.rotation.values, 1, 0)]


def turned_freely(p, orientation, momentum, time):
    """Return where angular momenta [N, 3] turn free blocks within a time (s): symmetric tops turn
    about L by L t / I_t, and about their own axis y."""
    along = np.einsum("ij,ij->i", orientation.apply([0.0, 1.0, 0.0]), momentum)
    own = np.zeros_like(momentum)
    own[:, 1] = time * along * (1 / p.inertia_along - 1 / p.inertia_across)
    about = Rotation.from_rotvec(time * momentum / p.inertia_across)
    return about * orientation * Rotation.from_rotvec(own)


def momenta_between(p, before, after, time):
    """Return the angular momenta [N, 3] that turn free blocks from one orientation to another."""
    inertia = np.array([p.inertia_across, p.inertia_along, p.inertia_across])
    found = np.zeros((len(before), 3))
    for _ in range(8):  # the error falls by as much as they turn within this time
        left = after * turned_freely(p, before, found, time).inv()
        found += before.apply(inertia * before.inv().apply(left.as_rotvec())) / time
    return found


def test_free_block_is_the_symmetric_top(pillar):
    """Torn off at the start, it turns by several radians about one angular momentum: what two
    samples have, all further ones have, to 1e-10. It comes from the load's impulse about the
    centroid, but for what the arms turn within 4 ms."""
    load = PUSH | {"direction": [0.28, -0.96, 0.0], "at": [0.05, 0.03]}
    scene = pillar(
        pillar={"length": 4.0, "side": 0.5, "block": 0.4},
        load=load,
        joints__tension=False,
        motion__rotation="finite",
        numerics__allow_large_motion=True,
        record={"stress": [], "velocity": [0.2], "interval": 1e-3, "energy": False},
        time__duration=0.4,
    )
    p, result = calibrate(scene), dem.simulate(scene)
    turns, times = orientations(result)[10:], result.time.values[10:]
    momentum = momenta_between(p, turns[0], turns[1], 1e-3)
    for now, time in zip(turns, times, strict=True):
        expected = turned_freely(p, turns[0], momentum, time - times[0])
        assert (expected.inv() * now).magnitude().max() < 1e-10
    turned = np.linalg.norm(momentum) / p.inertia_across * (times[-1] - times[0])
    assert turned > 4 and abs(1 - p.inertia_along / p.inertia_across) > 0.1
    impulse = load_history(scene).impulse(0.01) * p.area * np.array(load["direction"])
    assert momentum[0] == pytest.approx(np.cross([0.05, -0.2, 0.03], impulse), rel=0.1)


@pytest.mark.parametrize("joints", [{}, LOOSE], ids=["elastic", "no tension, friction"])
def test_momentum_and_angular_momentum_are_conserved(pillar, joints):
    """Both forces of a joint act at one place: from the end of the load on neither sum changes. Of
    motion from whole step to whole step, whose last digits are 1e-16 m and rad over 1e-5 s."""
    y = (0.25 + 0.5 * np.arange(10)).tolist()
    record = {"stress": [], "velocity": y, "interval": 1e-5}
    load = PUSH | {"direction": [0.6, 0.8, 0.0], "at": [0.1, 0.05]}
    scene = pillar(**BLOW | joints | {"load": load}, record=record)
    p, result = calibrate(scene), dem.simulate(scene)
    assert result.attrs["dt"] == 1e-5
    places = np.moveaxis(result.displacement.values, 1, 0) + np.multiply.outer(y, [0.0, 1.0, 0.0])
    turns, found = orientations(result), []
    for n in (450, 2000):
        linear = p.block_mass * (places[n] - places[n - 1]) / 1e-5
        own = momenta_between(p, turns[n - 1], turns[n], 1e-5)
        found.append((linear.sum(axis=0), (np.cross(places[n], linear) + own).sum(axis=0)))
    size = np.abs(linear).sum() * y[-1]
    assert turns[-1].magnitude().max() > 1e-3
    for old, new in zip(*found, strict=True):
        assert np.abs(new - old).max() < 1e-10 * size
    push = p.area * np.array(load["direction"]) * load_history(scene).impulse(0.02)
    assert found[1][0] == pytest.approx(push, rel=1e-10, abs=1e-10 * np.abs(push).max())


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
    """The edge of a cube's base is d/2 from the centre, its centroid d/2 above, so it topples
    beyond tan(slope) = 1 and not before."""
    assert incline(pillar, 0.96) < 1e-3
    assert incline(pillar, 1.04) > 0.3


def test_a_row_without_points_has_no_rotations(pillar):
    found = dem.simulate(pillar(**(BLOW | {"record__velocity": []})))
    assert found.rotation.shape == (0, found.sizes["time"], 3)

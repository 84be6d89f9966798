"""Waves of the effective medium as solutions of scenes: speeds, balance, a free face, space."""

import numpy as np
import pytest

from jointwave.cases.material.effective_medium import tensor
from jointwave.compare.engines import applies, solve
from jointwave.compare.exact.rock_mass import effective_medium as medium
from jointwave.compare.exact.rock_mass.field import field_of

#: lambda = mu = 20 GPa, so that K_n = 2 mu / 1 m and K_s = mu / 1 m.
LAW = {"normal_stiffness": 4e10, "shear_stiffness": 2e10, "spacing": 1.0}
OPENS = {"normal_stiffness": 4e9, "shear_stiffness": 4e11}
B = np.sqrt(8e6)
DIAGONAL = [np.sqrt(0.5), np.sqrt(0.5)]


@pytest.fixture
def crossed(rock_mass, joint):
    record = {"points": [[4.0, 6.0], [30.0, 20.0]], "joints": []}

    def scene(law=(), **changes):
        dips = {"bed": 0.0, "cross": 90.0}
        sets = [joint(**LAW | dict(law), name=name, dip=dip) for name, dip in dips.items()]
        return rock_mass(**{"joint_sets": sets, "record": record} | changes)

    return scene


@pytest.mark.parametrize(
    "kind, direction, speed, law",
    [
        ("P", [0.0, 1.0], 1.0801234497, {}),
        ("S", [0.0, 1.0], 0.5773502692, {}),
        ("P", DIAGONAL, 1.0, {}),
        ("S", DIAGONAL, 0.7071067812, {}),
        ("P", [0.0, 1.0], (5.375 / (5.375**2 - 0.125**2)) ** 0.5, OPENS),
        ("S", [0.0, 1.0], 1.1**-0.5, OPENS),
    ],
)
def test_waves_travel_at_the_speeds_of_the_medium(crossed, wave, kind, direction, speed, law):
    """Those of lambda = mu = rho = 1 with two orthogonal sets of spacing 1, K_n = 2 and K_s = 1, or
    K_n = 0.2 and K_s = 20, by which P is slower than S; 1 MPa on the front of 2500 kg/m3 moves
    particles at 1e6 / (2500 c) along the travel or to its left, the front bears that stress."""
    waves = [wave(kind=kind, direction=direction)]
    scene = crossed(law, waves=waves, time={"duration": 0.04})
    found, c, n = solve("effective-medium", scene), speed * B, np.array(direction)
    t, front = found.time.values, n if kind == "P" else np.array([-n[1], n[0]])
    for point, v, stress in zip(([4, 6], [30, 20]), found.velocity, found.stress, strict=True):
        a = (np.pi * (t - 1.5 * 0.005 - np.dot(point, n) / c) / 0.005) ** 2
        pulse = np.where(t > np.dot(point, n) / c, (1 - 2 * a) * np.exp(-a), 0.0)
        expected = 1e6 / (2500 * c) * pulse[:, None] * front
        assert np.abs(v.values - expected).max() < 1e-9 * np.abs(v).max()
        xx, yy, xy = stress.values.T
        traction = np.array([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]])
        assert np.abs(traction.T - 1e6 * pulse[:, None] * front).max() < 1e-3


def test_the_medium_is_in_balance(rock_mass, joint, wave):
    """rho v' = div sigma and sigma = C : e at any angle of three unlike sets, by differences of
    fourth order over 2 cm and 4 us: (k h)^4 / 30 of the shortest waves."""
    sets = [
        joint(**LAW | {"spacing": s}, name=str(s), dip=d) for s, d in ((1, 10), (2, 50), (3, -70))
    ]
    travel = [np.cos(1.1), np.sin(1.1)]
    h, centre, steps = 0.02, np.array([20.0, 15.0]), np.arange(-2, 3)
    line = [(centre + h * k * axis).tolist() for axis in np.eye(2) for k in steps if k or axis[0]]
    record = {"points": line, "joints": [], "interval": 4e-6}
    waves = [wave(direction=travel), wave(kind="S", direction=travel, amplitude=5e5)]
    scene = rock_mass(joint_sets=sets, waves=waves, record=record)
    found = solve("effective-medium", scene)
    v, u, stress = (found[name].values for name in ("velocity", "displacement", "stress"))
    along = [slice(0, 5), [5, 6, 2, 7, 8]]

    def slope(values):
        return (8 * (values[3] - values[1]) - (values[4] - values[0])) / (12 * h)

    (xx_x, _, xy_x), (_, yy_y, xy_y) = (slope(-stress[rows]).T for rows in along)
    rate = (8 * (v[2, 3:-1] - v[2, 1:-3]) - (v[2, 4:] - v[2, :-4])) / (12 * 4e-6)
    inertia = 2500 * rate
    force = np.array([xx_x + xy_y, xy_x + yy_y]).T[2:-2]
    assert np.abs(force - inertia).max() < 1e-6 * np.abs(inertia).max()
    strain = np.array([slope(u[rows]) for rows in along]).transpose(1, 2, 0)
    expected = np.einsum("ijkl,tkl->tij", tensor(medium.medium_stiffness(scene)), strain)
    off = -stress[2] - expected[:, [0, 1, 0], [0, 1, 1]]
    assert np.abs(off).max() < 1e-6 * np.abs(stress).max()


def test_its_waves_enter_where_joints_cross(crossed, joint):
    scene = crossed()
    found, own = field_of(scene), medium.medium_field(scene)
    assert isinstance(found, medium.MediumField)
    times, points = np.linspace(0, 0.02, 11), np.array([[0.0, 3.0], [40.0, 9.0]])
    for one, other in zip(found(points, times), own(points, times), strict=True):
        assert np.array_equal(one, other) and np.abs(one).max() > 0
    alone = crossed(joint_sets=[joint(**LAW), joint(name="fault", dip=80.0)])
    assert not isinstance(field_of(alone), medium.MediumField)


@pytest.mark.parametrize("kind", ["P", "S"])
def test_a_free_face_bears_no_traction_and_is_that_of_rock_with_stiff_joints(
    crossed, joint, wave, kind
):
    """Joints of 1e16 Pa/m soften rock by 6e10 / 1e16 of it, and delay waves by as little."""
    stiff = {"spacing": 1.0, "normal_stiffness": 1e16, "shear_stiffness": 1e16}
    sets = [joint(name=str(dip), dip=dip, **stiff) for dip in (20.0, 80.0)]
    tables = {"waves": [wave(kind=kind, direction=[0.28, 0.96])], "boundaries": {"top": "free"}}
    record = {"points": [[10.0, 30.0], [30.0, 20.0]], "joints": []}
    soft, hard = (crossed(**tables, record=record, **x) for x in ({}, {"joint_sets": sets}))
    for scene in (soft, hard):
        found = solve("effective-medium", scene)
        assert np.abs(found.stress[0, :, 1:]).max() < 1e-9 * np.abs(found.stress).max()
    plain = solve("parallel-joints", crossed(**tables, record=record, joint_sets=[]))
    for name in ("velocity", "displacement", "stress"):
        off = np.abs(found[name].values - plain[name].values).max()
        assert off < 1e-4 * np.abs(plain[name]).max()


def test_s_waves_in_space_move_rock_as_they_are_polarised(rock_mass, joint, wave):
    """Three sets across each other, of which two shear: all S waves along the vertical have one
    speed, of the slowness sqrt(rho (1 / mu + 2 / (K_s spacing)))."""
    law = {"spacing": 10.0, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    dips = ({"dip": 0.0}, {"dip": 90.0, "dip_direction": 0.0}, {"dip": 90.0, "dip_direction": 90.0})
    sets = [
        joint(name=f"set {k}", through=[5.0, 5.0, 5.0], **dip, **law) for k, dip in enumerate(dips)
    ]
    way, up = np.array([0.6, 0.8, 0.0]), [0.0, 0.0, 1.0]
    scene = rock_mass(
        domain={"size": [20.0, 20.0, 30.0]},
        joint_sets=sets,
        waves=[wave(kind="S", direction=up, period=0.02, polarisation=way.tolist())],
        boundaries={"front": "quiet", "back": "quiet"},
        time={"duration": 0.06},
        record={"points": [[8.0, 9.0, 11.0]], "joints": []},
    )
    assert applies("effective-medium", scene)
    found = solve("effective-medium", scene)
    v = found.velocity.values[0]
    assert abs(np.cross(v, way)).max() < 1e-9 * abs(v).max()
    arrival = float(found.time[np.abs(v @ way).argmax()])
    slowness = np.sqrt(2500 * (1 / 2e10 + 2 / (4e9 * 10.0)))
    assert arrival == pytest.approx(1.5 * 0.02 + 11.0 * slowness, abs=2e-4)

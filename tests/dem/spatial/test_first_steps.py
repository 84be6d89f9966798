"""A few steps from any motion, as plain Python: identities that hold at every step."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dem.spatial import record
from dem.spatial.build import energy_terms
from dem.spatial.ends import CLOSURE, MEAN, REACTION, VELOCITY
from dem.spatial.layout import LANES, packed, unpacked

pytestmark = pytest.mark.usefixtures("plain")

LAYER = [{"y": 1.0, "spacing_stiffness": 4e8, "shear_stiffness": 5e8, "damping_ratio": 0.1}]
EVERYTHING = {
    "pillar__length": 2.0,
    "soft_layers": LAYER,
    "joints": {"damping_ratio": 0.05},
    "damping__mass_proportional": 300.0,
    "damping__local": 0.2,
    "gravity": {"direction": [0.48, 0.6, -0.64], "static": False},
    "record": {"stress": [0.0, 0.7, 2.0], "velocity": [0.3, 1.75], "interval": 1e-5},
}
HOLDS = {"friction_angle": 20.0, "cohesion": 1e12}
ENDS = {
    "free": {"start": "free", "end": "free"},
    "quiet, matched": {"start": "quiet", "end": "matched"},
    "matched, fixed": {"start": "matched", "end": "fixed"},
}
TWO_TILES = {
    "pillar__length": 33.0,
    "ends": ENDS["quiet, matched"],
    "record": {"stress": [0.0, 31.9, 33.0], "velocity": [16.3, 32.1], "interval": 1e-5},
}
STEPS = 5


@pytest.fixture
def moving(row, at_rest):
    """Return a function that gives the `Row` of a scene in motion, and its energy's terms.

    size : of displacements (m) and rotations; a step's velocities move blocks as far.
    """

    def prepared(size, **changes):
        scene = row(**{**EVERYTHING, **changes})
        found, random = at_rest(scene), np.random.default_rng(3)
        freedoms, inertia = found.model.form.freedoms, found.model.block.inertia[3:, None]
        motion = size * random.uniform(-1, 1, (2, 6, found.p.block_count))[:, :freedoms]
        motion[1] /= found.time.dt
        motion = np.concatenate(motion)
        if found.model.form.finite:
            motion[3:6], motion[9:12] = motion[3:6] / 2, inertia * motion[9:12]
            motion = np.vstack([motion, np.ones(found.p.block_count)])
        found.put(motion)
        return found, energy_terms(scene, found.p)

    return prepared


def small(row):
    """Return displacements, rotations and their rates as small rotations have them."""
    motion = row.motion.copy()
    if row.model.form.finite:
        motion[3:6] *= 2
        motion[9:12] /= row.model.block.inertia[3:, None]
    return motion[: 2 * row.model.form.freedoms]


def energies(row, terms):
    """Return the samples taken of each energy, J."""
    return dict(zip(terms, row.energy(terms, STEPS), strict=True))


def assert_alike(one, other, tolerance):
    """Hold two rows, after their steps, to the same motion, forces, ends and energies."""
    pairs = [
        (small(one[0])[:6], small(other[0])[:6]),
        (small(one[0])[6:], small(other[0])[6:]),
        (one[0].samples.force[:, :3, :STEPS], other[0].samples.force[:, :3, :STEPS]),
        (one[0].samples.velocity[:, :3, :STEPS], other[0].samples.velocity[:, :3, :STEPS]),
        (one[0].state.ends, other[0].state.ends),
    ]
    energy = energies(*one), energies(*other)
    pairs += [(energy[0][term], energy[1][term]) for term in energy[0] if term in energy[1]]
    for expected, found in pairs:
        assert np.abs(found - expected).max() <= tolerance * np.abs(expected).max()


rows = pytest.mark.parametrize(
    "ends",
    [*({"ends": ends} for ends in ENDS.values()), TWO_TILES],
    ids=[*ENDS, "two tiles"],
)


@rows
@pytest.mark.parametrize("rule", [{"contact_points": 3}, {"point_rule": "gauss"}], ids=str)
def test_points_that_hold_are_the_face_as_a_whole(moving, ends, rule):
    """Joints that could slip, and do not, are summed over their points: the same sums."""
    joints = {"damping_ratio": 0.05, **rule}
    whole = moving(1e-6, **ends, joints=joints)
    points = moving(1e-6, **ends, joints={**joints, **HOLDS})
    assert points[0].model.form.points and not whole[0].model.form.points
    for row, _ in (whole, points):
        row.take(0, STEPS)
    assert_alike(whole, points, 1e-12)


@rows
@pytest.mark.parametrize("joints", [{}, {"friction_angle": 20.0}], ids=["holding", "slipping"])
def test_finite_rotations_are_small_ones_in_the_limit(moving, ends, joints):
    """What small rotations neglect of 1e-8 rad is 1e-8 of it, and of gaps of 1e-8 m beside levers
    of half a metre; a few times that after five steps."""
    joints = {"damping_ratio": 0.05, **joints}
    both = [moving(1e-8, **ends, joints=joints, motion__rotation=k) for k in ("small", "finite")]
    for row, _ in both:
        row.take(0, STEPS)
    assert_alike(*both, 1e-6)


@pytest.mark.parametrize("kept", [True, False], ids=["ledger", "none"])
def test_the_last_block_alone_has_the_end(moving, kept):
    """Of two tiles, a free and a quiet end differ in the last block's step, and in nothing else."""
    both = []
    for end in ("free", "quiet"):
        changes = {**TWO_TILES, "ends": {"start": "free", "end": end}}
        row, _ = moving(1e-6, **changes, record__energy=kept)
        row.take(0, 1)
        both.append(row.motion)
    differ = (both[0] != both[1]).any(axis=0)
    assert differ[-1] and not differ[:-1].any()


def test_ledger_of_two_tiles_closes(moving):
    """Over more steps than one pass takes: to round-off of what moves, at every sample."""
    row, terms = moving(1e-6, **TWO_TILES)
    row.take(0, 20)
    energy = dict(zip(terms, row.energy(terms, 20), strict=True))
    work = energy.pop("work")
    gained = sum(values - values[0] for values in energy.values()) - (work - work[0])
    assert energy["viscous"][-1] > 0.1 * energy["kinetic"][0]
    assert np.abs(gained).max() < 1e-12 * energy["kinetic"][0]


@pytest.mark.parametrize("rotation", ["none", "small", "finite"])
def test_kinetic_energy_is_of_the_rates_on_either_side_of_a_step(moving, rotation):
    """m v v' / 2, and I omega omega' / 2 apart from it; of what turns by 1e-8 rad, to 1e-6."""
    row, terms = moving(1e-8, motion__rotation=rotation, load__at=[0.0, 0.0])
    rates = slice(row.model.form.freedoms, None)
    before = small(row)[rates].copy()
    row.take(0, 1)
    product = before * small(row)[rates]
    inertia = np.array([row.p.inertia_across, row.p.inertia_along, row.p.inertia_across])
    found = {term: values[0] for term, values in energies(row, terms).items()}
    assert found["kinetic"] == pytest.approx(row.p.block_mass * product[:3].sum() / 2, rel=1e-12)
    assert ("rotation" in found) == (rotation != "none")
    if rotation != "none":
        expected = inertia @ product[3:].sum(axis=1) / 2
        rel = 1e-6 if rotation == "finite" else 1e-12
        assert found["rotation"] == pytest.approx(expected, rel=rel)


@pytest.mark.parametrize("ends", list(ENDS.values())[1:], ids=list(ENDS)[1:])
@pytest.mark.parametrize("rotation", ["none", "small", "finite"])
def test_ends_react_to_the_mean_velocity_of_the_step(moving, ends, rotation):
    """R = -(S w + C (p + p') / 2), p the velocity of the face, at the lever h of the centroid.

    Of a quiet end C is Z over the face; where there are springs, S and C are the model's. To
    round-off; with finite rotations, of 1e-8 rad, to what small ones neglect.
    """
    row, _ = moving(
        1e-8, ends=ends, motion__rotation=rotation, load__at=[0.0, 0.0], damping__local=None
    )
    p, size, h = row.p, row.model.form.freedoms, row.p.spacing / 2
    (x, z, area), tolerance = row.model.points, 1e-6 if rotation == "finite" else 1e-12
    normal = np.array([0, p.area, 0, area @ z**2, 0, area @ x**2])
    shear = np.array([p.area, 0, p.area, 0, area @ (x**2 + z**2), 0])
    dashpot = (p.impedance * normal + p.shear_impedance * shear)[:size]

    def face(block, side):
        v = small(row)[size:, block].copy()
        if size == 6:
            v[0], v[2] = v[0] + side * h * v[5], v[2] - side * h * v[3]
        return v

    for n in range(STEPS):
        before, closure = (face(0, 1), face(-1, -1)), row.state.ends[:, CLOSURE].copy()
        row.take(n, n + 1)
        after = face(0, 1), face(-1, -1)
        for k, kind in enumerate(ends.values()):
            spring, viscosity = row.model.ends[k, :2]
            if kind == "quiet":
                assert not spring.any()
                np.testing.assert_allclose(viscosity, dashpot, rtol=1e-13)
            expected = -(spring * closure[k] + viscosity * (before[k] + after[k]) / 2)
            state = row.state.ends[k]
            pairs = (REACTION, expected), (VELOCITY, before[k]), (MEAN, after[k])
            for at, values in pairs:
                assert np.abs(state[at] - values).max() <= tolerance * np.abs(values).max()


def energy_of(p, points, centres, turns):
    """Return the energy of the springs between two blocks at `centres` [2, 3] (m), J.

    The left block's points and those of the right block's face are apart, as the right block sees
    it, by the slip along x, the gap and the slip along z.
    """
    x, z, area = points
    on_face, h = np.stack([x, 0 * x, z], axis=1), np.array([0.0, p.spacing / 2, 0.0])
    left = centres[0] + turns[0].apply(on_face + h)
    right = centres[1] + turns[1].apply(on_face - h)
    apart = turns[1].apply(right - left, inverse=True)
    stiffness = np.array([p.shear_stiffness[0], p.stiffness[0], p.shear_stiffness[0]])
    return float(area @ (apart**2 @ stiffness)) / 2


def test_finite_forces_are_the_slope_of_the_energy(row, at_rest):
    """One step from rest gives each block dt times the slope of the energy along and about x, y, z.

    The energy has third derivatives of some 10 times its slope, by rad or m: central differences of
    1e-5 are off by 1e-9.
    """
    record = {"stress": [0.5], "velocity": [0.25], "interval": 1e-5}
    pair = at_rest(row(pillar__length=1.0, motion__rotation="finite", record=record))
    random, unloaded = np.random.default_rng(5), np.array([[0.0, 0.25, 0.0], [0.0, 0.75, 0.0]])
    whole = Rotation.from_rotvec([0.9, -0.4, 1.3])  # of both, and a little more of each
    turns = [whole * Rotation.from_rotvec(random.uniform(-0.05, 0.05, 3)) for _ in range(2)]
    centres = whole.apply(unloaded + random.uniform(-0.02, 0.02, (2, 3)))
    motion = np.zeros((13, 2))
    motion[:3] = (centres - unloaded).T
    motion[[3, 4, 5, 12]] = np.stack([turn.as_quat() for turn in turns], axis=1)
    pair.put(motion)
    after = pair.model.load.stress.size  # the load is not in the energy
    pair.take(after, after + 1)
    gained = pair.motion[6:12] / pair.time.dt
    gained[:3] *= pair.p.block_mass

    def energy(block, k, size):
        moved, both = centres.copy(), list(turns)
        if k < 3:
            moved[block, k] += size
        else:
            both[block] = Rotation.from_rotvec(size * np.eye(3)[k - 3]) * both[block]
        return energy_of(pair.p, pair.model.points, moved, both)

    slope = [[energy(b, k, 1e-5) - energy(b, k, -1e-5) for b in (0, 1)] for k in range(6)]
    error = gained + np.array(slope) / 2e-5
    for kind in (slice(0, 3), slice(3, 6)):
        assert np.abs(error[kind]).max() < 1e-7 * np.abs(gained[kind]).max()


def test_a_joint_is_broken_where_all_its_points_are(row, at_rest, monkeypatch):
    """The first of three at all four points, the second at three of them, the last at none."""
    breaks = {
        "tensile_strength": 5e4,
        "fracture_energy": 1.0,
        "cohesion": 1e4,
        "damping_ratio": 0.1,
    }
    scene = row(pillar__length=2.0, joints=breaks, record={"stress": [0.5]})
    built, found = at_rest(scene), []
    form, state = built.model.form, built.state
    opening = np.tile(built.p.critical_opening, (4, 1)) * [1.0, 1.0, 0.99]
    opening[2, 1] *= 0.99
    history = unpacked(state.history, LANES, 3)
    history[form.openings] = opening
    state.history[:] = packed(history, LANES)
    monkeypatch.setattr(record, "with_fragments", lambda *given: found.append(given[2:]))
    record.with_breaks(None, built.p, built.model, state)
    ((broken, velocity),) = found
    assert broken.tolist() == [True, False, False]
    assert velocity.shape == (4, 3)

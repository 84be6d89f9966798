"""Snapshots of the blocks are what receivers in every block would record, and change nothing."""

import subprocess
import sys

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases import SceneError
from jointwave.results.snapshots import snapshots_of

BLOCKS, SPACING, SIDE = 16, 0.5, 0.5
CENTRES = [SPACING * (i + 0.5) for i in range(BLOCKS)]
CONTACTS = [SPACING * i for i in range(BLOCKS + 1)]
EVERYWHERE = {
    "pillar__length": SPACING * BLOCKS,
    "load__amplitude": 1e6,
    "time__duration": 0.02,
    "ends__start": "matched",
    "ends__end": "fixed",
    "joints__damping_ratio": 0.02,
    "record": {"stress": CONTACTS, "velocity": CENTRES, "interval": 1e-4, "energy": False},
}
#: Whose ledger is kept too; of others kernels compile in half the time without it.
LEDGER = ("axial", "translation", "small rotation")
OBLIQUE = {"load__direction": [0.48, 0.6, -0.64], "load__at": [0.1, -0.05]}
SLIPS = {"joints__friction_angle": 20.0, "joints__cohesion": 1e4}
MOTIONS = {
    "axial": {},
    "breaking": {
        "joints__tensile_strength": 1e5,
        "joints__fracture_energy": 5.0,
        "ends__end": "free",
    },
    "translation": {"load__direction": [0.6, 0.8, 0.0], "motion__rotation": "none"},
    "small rotation": OBLIQUE,
    "slip": OBLIQUE | SLIPS,
    "finite rotation": OBLIQUE | SLIPS | {"motion__rotation": "finite"},
}


@pytest.fixture(params=MOTIONS)
def row(pillar, request):
    """Return a function of record.fields that gives 16 blocks, recorded at every place."""

    def scene(fields):
        keys = EVERYWHERE | MOTIONS[request.param]
        more = {} if fields is None else {"fields": fields}
        keys["record"] = keys["record"] | {"energy": request.param in LEDGER} | more
        return pillar(**keys)

    return scene


def test_a_run_with_snapshots_is_the_same_to_the_last_bit(row):
    bare, filmed = dem.simulate(row(None)), dem.simulate(row(7e-4))
    assert {str(v) for v in filmed.data_vars} - {str(v) for v in bare.data_vars} == {
        "field_points",
        "field_cells",
        "field_block",
        "field_displacement",
        "field_velocity",
        "field_stress",
    }
    for name in bare.data_vars:
        np.testing.assert_array_equal(bare[name].values, filmed[name].values, str(name))


def test_snapshots_are_what_receivers_record(row):
    """At every block's centroid and contact, to the round-off of the mean over eight corners."""
    result = dem.simulate(row(7e-4))
    found, rows = snapshots_of(result), slice(None, None, 7)
    np.testing.assert_array_equal(found.time, result.time.values[rows])
    for name in ("displacement", "velocity"):
        corners = getattr(found, name).reshape(len(found.time), BLOCKS, 8, 3)
        recorded = np.moveaxis(result[name].values[:, rows], 0, 1)
        axes = [1] if recorded.shape[2] == 1 else [0, 1, 2]
        scale = np.abs(corners).max()
        np.testing.assert_allclose(
            corners.mean(axis=2)[..., axes], recorded, rtol=0, atol=1e-15 * scale
        )
    contacts = result.stress.values[:, rows].T
    np.testing.assert_array_equal(found.stress, (contacts[:, :-1] + contacts[:, 1:]) / 2)


def test_small_rotations_turn_corners_as_vectors(pillar):
    """A corner at r moves by u + theta x r, theta as recorded."""
    record = EVERYWHERE["record"] | {"fields": 1e-3, "energy": True}
    result = dem.simulate(pillar(**EVERYWHERE | OBLIQUE | {"record": record}))
    found = snapshots_of(result)
    u = found.displacement.reshape(-1, BLOCKS, 8, 3)
    theta = np.moveaxis(result.rotation.values[:, ::10], 0, 1)[:, :, None]
    r = (found.points.reshape(BLOCKS, 8, 3) - np.array(CENTRES)[:, None, None] * [0, 1, 0])[None]
    turned = u - u.mean(axis=2, keepdims=True)
    scale = np.abs(turned).max()
    assert scale > 1e-5
    np.testing.assert_allclose(turned, np.cross(theta, r), rtol=0, atol=1e-11 * scale)


TOPPLING = {
    "pillar__length": 1.0,
    "load__amplitude": 6e6,
    "load__direction": [0.6, 0.8, 0.0],
    "load__at": [0.2, 0.1],
    "motion__rotation": "finite",
    "ends__start": "free",
    "ends__end": "free",
    "joints__tension": False,
    "time__duration": 0.1,
    "record": {"velocity": [0.25, 0.75], "interval": 5e-5, "fields": 5e-5, "energy": False},
}


@pytest.fixture
def toppled(pillar, solved):
    """Return the result of blocks that topple, run once."""
    return solved("toppling", dem.simulate, pillar(**TOPPLING))


def test_finite_rotations_keep_the_shape_of_blocks(toppled):
    """Blocks that turn by more than a third of a turn keep all distances, and turn as recorded."""
    from scipy.spatial.transform import Rotation

    result = toppled
    found = snapshots_of(result)
    x = (found.points + found.displacement).reshape(-1, 2, 8, 3)
    arms, rest = x - x.mean(axis=2, keepdims=True), found.points.reshape(2, 8, 3)
    rest = rest - rest.mean(axis=1, keepdims=True)
    turns = Rotation.from_rotvec(np.moveaxis(result.rotation.values, 0, 1).reshape(-1, 3))
    turns = turns.as_matrix().reshape(-1, 2, 3, 3)
    assert np.trace(turns, axis1=2, axis2=3).min() < 0  # 1 + 2 cos(angle)
    np.testing.assert_allclose(arms, np.einsum("tbij,bcj->tbci", turns, rest), rtol=0, atol=1e-13)


def test_velocity_of_turning_blocks_is_that_of_a_rigid_body(toppled):
    """v - v_centre is at right angles to the arm, and the rate of what is drawn, to second order:
    differences over two samples are off by four times as much as those over one."""
    found = snapshots_of(toppled)
    # The blow is over, and nothing holds the blocks: they turn freely.
    late = found.time > 0.03
    x = (found.points + found.displacement)[late].reshape(-1, 2, 8, 3)
    v = found.velocity[late].reshape(-1, 2, 8, 3)
    arms, pace = (a - a.mean(axis=2, keepdims=True) for a in (x, v))
    scale = np.abs(pace).max()
    assert scale > 10
    assert np.abs((arms * pace).sum(axis=3)).max() < 1e-13 * scale
    h = 5e-5
    one = np.abs((x[3:-1] - x[1:-3]) / (2 * h) - v[2:-2]).max()
    two = np.abs((x[4:] - x[:-4]) / (4 * h) - v[2:-2]).max()
    assert one < 1e-4 * scale
    assert two / one == pytest.approx(4, rel=0.01)


def test_a_broken_joint_opens_between_its_own_nodes(pillar):
    """Between the facing corners is the gap of the joint; where joints hold it is elastic."""
    breaking = EVERYWHERE | MOTIONS["breaking"]
    changes = breaking | {"record": breaking["record"] | {"fields": 0.02}}
    result = dem.simulate(pillar(**changes))
    found, broke = snapshots_of(result), ~np.isnan(result.break_time.values)
    u = found.displacement[-1].reshape(BLOCKS, 8, 3)
    left, right = [2, 3, 6, 7], [1, 0, 5, 4]
    np.testing.assert_array_equal(
        found.points.reshape(BLOCKS, 8, 3)[:-1, left], found.points.reshape(BLOCKS, 8, 3)[1:, right]
    )
    gaps = u[1:, right, 1] - u[:-1, left, 1]
    moved = result.displacement.values[:, -1, 0]
    np.testing.assert_allclose(gaps, np.repeat(np.diff(moved)[:, None], 4, axis=1), atol=1e-16)
    critical = 2 * 5.0 / 1e5
    assert 0 < broke.sum() < BLOCKS - 1
    assert gaps[broke].max() > critical > gaps[~broke].max()


def test_too_many_snapshots_of_too_many_blocks_are_refused(pillar, monkeypatch):
    """Whatever memory there is: no file holds them."""
    monkeypatch.setenv("JOINTWAVE_MEMORY", "1e6")
    long = {"pillar__length": 1e6, "record__fields": 1e-3}
    with pytest.raises(SceneError, match=r"record\.fields = .*121 snapshots of 16,000,000 nodes"):
        dem.simulate(pillar(**long))


def test_a_run_without_snapshots_imports_nothing_for_them(tmp_path):
    code = (
        "import sys; sys.argv = ['jointwave', 'run', '%s', '--out', %r, %s]\n"
        "from jointwave.compare.cli.program import main\n"
        "try: main()\n"
        "except SystemExit as end: assert end.code == 0, end.code\n"
        "mine = {'jointwave.compare.runs.field_files', 'meshio'}\n"
        "print(sorted(mine & set(sys.modules)))"
    )
    scene = "guo-li-2002/fig-03"
    for options, imported in (("", "[]"), ("'--set', 'record.fields=1e-2'", "meshio")):
        command = [sys.executable, "-c", code % (scene, str(tmp_path), options)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        assert imported in done.stdout.splitlines()[-1]

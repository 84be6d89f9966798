"""Snapshots: exact stress in every linear cell, what receivers record, and joints that part."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from jointwave.cases.errors import InterruptedRun
from jointwave.continuum.receivers.snapshots import RockRecorder
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.results.snapshots import snapshots_of
from jointwave.results.stress import stress_components
from tests.continuum.bodies import SHEAR
from tests.continuum.test_patch import STRESS, stressed

FLAT = {"dip": 0.0, "spacing": 1.7}
STEEP = {"dip": -65.0, "spacing": 1.9}
SLANTED = {"dip": 35.0, "dip_direction": 110.0, "spacing": 2.3}
GIVEN = {"xx": 2e6, "yy": 3e6, "xy": 5e5}
DEEP = GIVEN | {"zz": 4e6, "yz": 2e5, "xz": -1e5}
#: Dimension, joint, order, kind, and linear cells in a cell.
CASES = [(2, FLAT, order, "quad", order**2) for order in (1, 3)]
CASES += [(2, STEEP, 1, "triangle", 1), (2, STEEP, 2, "triangle", 4)]
CASES += [(3, FLAT, 2, "hexahedron", 8), (3, SLANTED, 1, "tetra", 1), (3, SLANTED, 2, "tetra", 8)]
BESIDE = [0.0, 0.25, 2.0]  # m along a pillar: ends, and the middle of a block
PUSH = {"kind": "pressure", "side": "top", "shape": "sine", "period": 1e-3, "amplitude": 1e6}


def volumes(s):
    """Return the volume of linear cells, positive where corners are in VTK's order."""
    x = s.points[s.cells]
    if s.kind in ("triangle", "quad"):
        rolled = np.roll(x, -1, axis=1)
        return (x[..., 0] * rolled[..., 1] - x[..., 1] * rolled[..., 0]).sum(axis=1) / 2
    tetra = [[0, 1, 2, 3]]
    if s.kind == "hexahedron":  # around one diagonal
        ring = [1, 2, 3, 7, 4, 5, 1]
        tetra = [[0, b, a, 6] for a, b in pairwise(ring)]
    arms = x[:, tetra][:, :, 1:] - x[:, tetra][:, :, :1]
    sign = -1 if s.kind == "hexahedron" else 1
    return sign * np.linalg.det(arms).sum(axis=1) / 6


def snapshot(found, u, v=None):
    """Return the snapshots of a body at rest, and then at displacements u and velocities v."""
    scene, steps = found.scene, SimpleNamespace(last=(0 * u, 0 * u, 0 * u))
    recorder = RockRecorder(scene, found, steps)
    recorder.record_if_due(0)
    steps.last = u, 0 * u if v is None else v, u
    recorder.record_if_due(recorder.every)
    time = np.arange(recorder.every + 1) * scene.interval
    empty = xr.Dataset(coords={"time": time})
    return snapshots_of(recorder.add_to(empty))


@pytest.mark.parametrize(("dim", "joint", "order", "kind", "parts"), CASES)
def test_uniform_stress_is_that_of_every_linear_cell(rock_mass, dim, joint, order, kind, parts):
    given = GIVEN if dim == 2 else DEEP
    record = {"points": [], "interval": 1e-4, "fields": 1e-4}
    continuum = {"order": order, "size": 1.7}
    scene = rock_mass(joint, dim=dim, continuum=continuum, prestress=given, record=record)
    found = body_of(scene)
    s = snapshot(found, stressed(found, STRESS[:dim, :dim]))
    expected = scene.prestress.tensor - STRESS[:dim, :dim]
    pairs = stress_components(dim).values()
    assert s.kind == kind
    assert len(s.cells) == parts * len(found.body.block)
    assert np.allclose(s.stress[1], [expected[i, j] for i, j in pairs], rtol=0, atol=1e-2)
    size = volumes(s)
    assert size.min() > 0
    own = np.bincount(s.block, size)
    assert np.allclose(own, found.blocks.volume, rtol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_rock_that_is_whole_across_periodic_sides_is_shown_within_them(rock_mass, order):
    """Slabs under shear: u_x = y."""
    record = {"points": [], "fields": 1e-4}
    sides = {"left": "periodic", "right": "periodic"}
    continuum = {"cell": "triangle", "order": order}
    scene = rock_mass(FLAT, continuum=continuum, boundaries=sides, record=record)
    found = body_of(scene)
    assert found.body.tied is not None
    s = snapshot(found, (found.body.x[:, [1]] * [1.0, 0.0]).ravel())
    assert np.allclose(s.stress[1], [0.0, 0.0, -SHEAR], rtol=0, atol=1e-9 * SHEAR)
    assert np.allclose(s.displacement[1, :, 0], s.points[:, 1], rtol=0, atol=1e-12)
    assert volumes(s).min() > 0 and np.isclose(volumes(s).sum(), 24.0, rtol=1e-12)


def test_dashpots_of_the_rock_carry_stress(rock_mass):
    """As much as the strain of a time constant."""
    keys = {"rayleigh": {"frequencies": [100.0, 500.0], "ratios": [0.01, 0.05]}}
    found = body_of(rock_mass(record={"points": [], "fields": 1e-4}, damping=keys))
    eta, u = found.materials[-1].time_constant, (found.body.x @ STRESS[:2, :2]).ravel()
    assert eta > 0
    one, other = snapshot(found, u), snapshot(found, 0 * u, u / eta)
    np.testing.assert_allclose(other.stress, one.stress, rtol=1e-12)


@pytest.mark.parametrize(
    ("dim", "cell", "kind"),
    [(1, "hexahedron", "line"), (2, "hexahedron", "quad"), (3, "simplex", "tetra")],
)
def test_a_pillar_has_the_stress_along_it(pillar, dim, cell, kind):
    """Rock that shortens along y alone."""
    scene = pillar(
        pillar__length=2.0,
        rock__intact_modulus=5e10,
        numerics__continuum={"dim": dim, "cell": cell, "elements_per_block": 2},
        record={"velocity": [0.0], "fields": 1e-4},
        prestress={"normal": 1e6},
    )
    found, along = body_of(scene), dim // 2
    u = np.zeros((len(found.body.x), found.body.components))
    u[:, along] = -1e-5 * found.body.x[:, along]
    s = snapshot(found, u.ravel())
    k = 0 if dim == 1 else 1
    expected = 1e6 + 1e-5 * found.materials[0].stiffness[k, k]
    assert s.kind == kind
    assert np.allclose(s.stress[1], expected, rtol=1e-10)
    assert np.allclose(s.displacement[1, :, 1], -1e-5 * s.points[:, 1], rtol=0, atol=1e-18)
    middle = s.points[s.cells, 1].mean(axis=1)
    assert np.array_equal(s.block, middle // scene.pillar.block)


def pushed(rock_mass, scheme, **tables):
    """Return a scene that slips under a pressure, recorded at its corners and on a joint."""
    joint = {"dip": 0.0, "through": [3.0, 2.0], "friction_angle": 30.0}
    record = {"points": [[0.0, 4.0], [6.0, 0.0]], "interval": 2e-5, "fields": 1.6e-4}
    continuum = {"scheme": scheme, "order": 2, "steps_per_period": 50}
    table = {"loads": [PUSH], "boundaries": {"left": "quiet"}, "record": record}
    return rock_mass(joint, continuum=continuum, **table | tables)


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_snapshots_are_what_receivers_record(rock_mass, scheme):
    """At corners, to the last digits; samples are the same bit for bit as without snapshots."""
    scene = pushed(rock_mass, scheme)
    found = simulate(scene)
    bare = {key: value for key, value in scene.record if key != "fields"}
    plain = simulate(pushed(rock_mass, scheme, record=bare))
    for name in ("velocity", "displacement", "stress", "energy"):
        np.testing.assert_array_equal(found[name], plain[name], err_msg=name)
    s = snapshots_of(found)
    np.testing.assert_array_equal(s.time, found.time.values[::8])
    assert not s.displacement[0].any()
    for k, place in enumerate(scene.record.points):
        (node,) = np.flatnonzero(np.abs(s.points[:, :2] - place).max(axis=1) < 1e-9)
        for name in ("velocity", "displacement"):
            known = found[name].values[k, ::8]
            away = np.abs(getattr(s, name)[:, node, :2] - known).max()
            assert away < 1e-12 * np.abs(known).max()


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_an_interrupted_run_has_all_snapshots(rock_mass, keeper_at, scheme):
    scene, keeper = pushed(rock_mass, scheme), keeper_at(45)
    whole = simulate(scene)
    with pytest.raises(InterruptedRun):
        simulate(scene, keeper=keeper)
    found = simulate(scene, keeper=keeper)
    for name in ("field_time", "field_displacement", "field_velocity", "field_stress"):
        np.testing.assert_array_equal(found[name], whole[name], err_msg=name)


def short(pillar, dim=1, **changes):
    """Return four blocks of rock, keys changed."""
    keys = {
        "pillar__length": 2.0,
        "rock__intact_modulus": 8.64e10,
        "load": {"shape": "sine", "amplitude": 1e6, "period": 2e-3, "cycles": 1},
        "ends__end": "free",
        "time__duration": 4e-3,
        "record": {"velocity": BESIDE, "interval": 2e-5, "fields": 4e-4},
        "numerics__continuum__dim": dim,
    }
    return pillar(**keys | changes)


@pytest.mark.parametrize("quantity", ["displacement", "velocity"])
def test_snapshots_of_the_bar_are_what_receivers_record(pillar, quantity):
    """At nodes that are receivers: both ends, and the middle of the first block."""
    result = simulate(short(pillar))
    found, recorded = snapshots_of(result), result[quantity].values[:, ::20, 0]
    np.testing.assert_array_equal(found.time, result.time.values[::20])
    for y, waveform in zip(BESIDE, recorded, strict=True):
        node = int(np.argmin(np.abs(found.points[:, 1] - y)))
        assert found.points[node, 1] == pytest.approx(y, abs=1e-12)
        scale = np.abs(recorded).max()
        np.testing.assert_allclose(
            getattr(found, quantity)[:, node, 1], waveform, rtol=0, atol=1e-13 * scale
        )


@pytest.mark.parametrize("dim", [1, 3])
def test_a_joint_without_tension_opens_between_its_own_nodes(pillar, dim):
    """Facing nodes lie at one place, and part once tension comes."""
    scene = short(pillar, dim, joints__tension=False)
    found = snapshots_of(simulate(scene))
    nodes = np.unique(found.cells[found.block == 2]), np.unique(found.cells[found.block == 3])
    facing = [n[np.isclose(found.points[n, 1], 1.5)] for n in nodes]
    left, right = (n[np.lexsort(found.points[n][:, [0, 2]].round(9).T)] for n in facing)
    np.testing.assert_allclose(found.points[left], found.points[right], atol=1e-12)
    gap = found.displacement[:, right, 1] - found.displacement[:, left, 1]
    assert gap.max() > 0.1 * np.abs(found.displacement).max()


def test_stress_of_a_slow_push_is_the_load(pillar):
    """Two widths and more from a fixed end, which only there keeps the rock from widening."""
    changes = {"load": {"shape": "step", "amplitude": 1e6}, "ends__end": "fixed"}
    changes |= {"joints__damping_ratio": 0.5, "time__duration": 0.05}
    scene = short(pillar, 2, **changes)
    found = snapshots_of(simulate(scene))
    assert found.stress[-1, found.block < 2] == pytest.approx(1e6, rel=1e-5)

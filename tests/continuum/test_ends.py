"""What acts on the end faces: force and moment of a load, the dashpots' and the walls' freedoms."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Clock
from jointwave.continuum.build import discretise
from jointwave.continuum.ends import end_stiffness, fixed_ends, load_on, quiet_ends

OBLIQUE, ACROSS = [0.48, 0.6, -0.64], [0.6, 0.8, 0.0]
LOADS = {
    "axial": {"load__direction": [0.0, 1.0, 0.0]},
    "oblique": {"load__direction": OBLIQUE},
    "eccentric": {"load__at": [0.1, -0.05]},
    "oblique and eccentric": {"load__direction": OBLIQUE, "load__at": [0.1, -0.05]},
    "twist": {"load__direction": [0.0, 1.0, 0.0], "load__arm": 0.3},
    "couple about all axes": {"load__direction": OBLIQUE, "load__arm": 0.3},
}
PLANE_LOADS = {
    "axial": {"load__direction": [0.0, 1.0, 0.0]},
    "oblique": {"load__direction": ACROSS},
    "oblique and eccentric": {"load__direction": ACROSS, "load__at": [0.1, 0.0]},
    "couple": {"load__direction": [0.0, 0.0, 1.0], "load__arm": 0.3},
}
MESHES = {
    2: [("hexahedron", order, across) for order in (1, 2, 3, 4) for across in (1, 3)]
    + [("simplex", order, 3) for order in (1, 2)],
    3: [("hexahedron", 1, 1), ("hexahedron", 1, 3), ("hexahedron", 2, 1), ("hexahedron", 4, 2)]
    + [("simplex", order, 2) for order in (1, 2)],
}
EVERY_LOAD = [(2, PLANE_LOADS[name], mesh) for name in PLANE_LOADS for mesh in MESHES[2]]
EVERY_LOAD += [(3, LOADS[name], mesh) for name in LOADS for mesh in MESHES[3]]
ONE_SAMPLE = Clock(1e-6, 1, 1)


def meshed(short, dim: int, mesh: tuple[str, int, int], **changes):
    """Return a scene with such elements, and its body."""
    keys = dict(zip(("cell", "order", "elements_across"), mesh, strict=True))
    numerics = {f"numerics__continuum__{key}": value for key, value in keys.items()}
    scene = short(**numerics, **changes)
    return scene, discretise(scene, "jointed", dim).body


@pytest.mark.parametrize(("dim", "load", "mesh"), EVERY_LOAD)
def test_load_has_the_force_and_the_moment_that_the_scene_gives(dim, load, mesh, short):
    """About the centre of the face, of a unit end stress: all consistent with linear motion."""
    scene, body = meshed(short, dim, mesh, **load)
    loaded = load_on(scene, calibrate(scene), body, ONE_SAMPLE)
    force, moment = np.zeros(3), np.zeros(3)
    for c in range(dim):
        at = np.zeros(body.mass.size)
        at[loaded.freedom] = loaded.share
        push = at[body.freedom(np.arange(len(body.x)), c)]
        force[c] = push.sum()
        arms = np.zeros((len(body.x), 3))
        arms[:, :dim] = body.x
        moment += np.cross(arms, np.eye(3)[c]).T @ push
    area, given = 0.25, scene.load
    if given.arm is not None:
        expected = np.zeros(3), area * given.arm * np.array(given.direction)
    else:
        expected = area * np.array(given.direction), None
        lever = np.array([given.at[0], 0.0, given.at[1]])
        expected = expected[0], np.cross(lever, expected[0])
    assert np.abs(force - expected[0]).max() < 1e-13
    assert np.abs(moment - expected[1]).max() < 1e-13


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_quiet_ends_have_the_impedance_of_the_rock_mass(dim, model, short):
    """Z A along the axis at each end, Z_s A across it."""
    scene = short(ends={"start": "quiet", "end": "quiet"}, numerics__continuum__elements_across=2)
    p, body = calibrate(scene), discretise(scene, model, dim).body
    quiet = quiet_ends(scene, p, body, model, 1e-6, body.mass)
    total = np.zeros(body.mass.size)
    np.add.at(total, quiet.freedom, quiet.viscosity)
    nodes = np.arange(len(body.x))
    for c in range(dim):
        of_direction = total[body.freedom(nodes, c)]
        z = p.impedance if dim == 1 or c == 1 else p.shear_impedance
        assert of_direction[body.y < 1e-9].sum() == pytest.approx(0.25 * z, rel=1e-13)
        assert of_direction[body.y > 2 - 1e-9].sum() == pytest.approx(0.25 * z, rel=1e-13)
    assert quiet.springs is None
    assert quiet.beta == pytest.approx(quiet.viscosity * 5e-7 / body.mass[quiet.freedom])


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_matched_ends_have_half_a_joint_in_front_in_jointed_rock_alone(dim, short):
    scene = short(ends__end="matched", numerics__continuum__elements_across=2)
    p = calibrate(scene)
    for model in ("jointed", "equivalent"):
        body = discretise(scene, model, dim).body
        quiet = quiet_ends(scene, p, body, model, 1e-6, body.mass)
        stiffness = end_stiffness(scene, p, body, model)
        if model == "equivalent":
            assert quiet.springs is None and not stiffness.any()
            continue
        for c in range(dim):
            along = dim == 1 or c == 1
            k = 2 * (p.regular_own_stiffness if along else p.regular_own_shear_stiffness)
            of_direction = np.isin(quiet.freedom, body.freedom(np.arange(len(body.x)), c))
            assert quiet.springs.stiffness[of_direction].sum() == pytest.approx(0.25 * k, rel=1e-12)
            of_direction = body.freedom(np.arange(len(body.x)), c)
            assert stiffness[of_direction].sum() == pytest.approx(0.25 * k, rel=1e-12)


@pytest.mark.parametrize("cell", ["hexahedron", "simplex"])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_fixed_ends_hold_every_node_of_the_face_in_every_direction(dim, cell, short):
    scene, body = meshed(short, dim, (cell, 2, 2), ends__end="fixed")
    fixed = fixed_ends(scene, body, ONE_SAMPLE)
    face = np.flatnonzero(body.y > 2 - 1e-9)
    expected = np.concatenate([body.freedom(face, c) for c in range(dim)])
    assert np.array_equal(np.sort(fixed.freedom), np.sort(expected))
    assert fixed.step is None and not fixed.direction.any()


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_shaken_base_moves_every_node_of_the_face_alike(dim, short):
    load = {"shape": "sine", "amplitude": 0.1, "period": 1e-3, "quantity": "velocity"}
    direction = {1: [0.0, 1.0, 0.0], 2: ACROSS, 3: OBLIQUE}[dim]
    scene = short(ends__start="fixed", load={**load, "direction": direction})
    body = discretise(scene, "jointed", dim).body
    fixed = fixed_ends(scene, body, Clock(1e-5, 1, 101))
    for c in range(dim):
        of_direction = np.isin(fixed.freedom, body.freedom(np.arange(len(body.x)), c))
        assert (fixed.direction[of_direction] == (1.0 if dim == 1 else direction[c])).all()
    assert fixed.step.size == 101  # one for each step up to the last sample, and behind it
    moved = np.cumsum(fixed.step)[49]
    assert moved == pytest.approx(0.1 * 1e-3 / np.pi, rel=1e-12)

"""Inertia, contact points and the critical step of blocks in the plane."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from jointwave.cases.geometry.cell_complex import GeometryError
from jointwave.cases.material.contact_points import points_of
from jointwave.cases.material.rock_mass import constrained_modulus
from jointwave.cases.partition.scene import blocks_of_domain as cut
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.plane import IntactRock
from tests.cases.material.block_stiffness import block_stiffness, jump
from tests.cases.partition.polygons import periodic_contacts, points_between

DENSITY, NORMAL, SHEAR = 2500.0, 1.1e10, 4e9


def joint_set(name, dip, **keys):
    law = {"normal_stiffness": NORMAL, "shear_stiffness": SHEAR, "point_rule": "gauss"}
    return JointSet(name=name, dip=dip, **law | keys)


def assembled(count, pieces):
    """The stiffness matrix of all blocks [3 count, 3 count], spring by spring."""
    total = np.zeros((3 * count, 3 * count))
    for blocks, frame, arm, springs in pieces:
        rows = jump(frame[:, None], arm[:, :, None])
        for p, axis in np.ndindex(springs.shape):
            row = np.zeros(3 * count)
            for side, sign in ((0, -1), (1, 1)):
                first = 3 * blocks[p, side]
                row[first : first + 3] += sign * rows[p, side, axis]
            total += springs[p, axis] * np.outer(row, row)
    return total


def bound(own, weight):
    """Return the critical step that follows from blocks held by their neighbours, s."""
    scale = 1 / np.sqrt(weight)
    largest = np.linalg.eigvalsh(scale[:, :, None] * own * scale[:, None, :]).max()
    return 2 / np.sqrt(2 * largest)


def masses_of(found):
    """Masses and moments of inertia of blocks, [n, 3]."""
    polar = np.trace(found.second_moment, axis1=1, axis2=2)
    return DENSITY * np.stack([found.volume, found.volume, polar], axis=1)


def uniform(found, contacts, sets, shear=SHEAR, shift=(0.0, 0.0)):
    """Return the points of contacts that are alike."""
    stiffness = np.full((2, len(contacts)), [[NORMAL], [shear]])
    return points_between(found, contacts, sets, *stiffness, shift)


def test_inertia_of_a_rectangle():
    """Mass rho b h, moment m (b^2 + h^2) / 12, per metre."""
    sets = [joint_set("flat", 0.0, spacing=1.0), joint_set("steep", 90.0, spacing=2.0)]
    found = masses_of(cut(Domain(size=[4.0, 2.0]), sets))
    np.testing.assert_allclose(found[:, :2], 2 * DENSITY, rtol=1e-15)
    np.testing.assert_allclose(found[:, 2], 2 * DENSITY * 5 / 12, rtol=1e-14)


@pytest.mark.parametrize("count", range(1, 9))
def test_rules_integrate_what_they_should(count):
    """Gauss: polynomials up to degree 2 n - 1; midpoint: 1 - 1/n^2 of the bending stiffness."""
    x, w = points_of("gauss", count)
    for degree in range(2 * count):
        assert w @ x**degree == pytest.approx(1 / (degree + 1), rel=1e-13)
    x, w = points_of("midpoint", count)
    assert w @ (x - 0.5) ** 2 == pytest.approx((1 - 1 / count**2) / 12, abs=1e-15)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_a_block_resists_what_its_points_take_of_its_motion(dim):
    """k (a . (u + phi x r))^2, twice the energy of each spring, of any motion."""
    rng = np.random.default_rng(dim)
    turns = dim * (dim - 1) // 2
    frame, arm = rng.normal(size=(5, dim, dim)), rng.normal(size=(5, 2, dim))
    blocks, springs = np.array([[0, 1]] * 3 + [[1, 2]] * 2), rng.uniform(1, 2, size=(5, dim))
    found = block_stiffness(3, blocks, frame, arm, springs)
    motion = rng.normal(size=dim + turns)
    u, phi = motion[:dim], np.zeros(3)
    phi[3 - turns :] = motion[dim:]
    for block, side in ((0, 0), (2, 1)):
        own = blocks[:, side] == block
        raised = np.pad(arm[own, side], ((0, 0), (0, 3 - dim)))
        moved = u + np.cross(phi, raised)[:, :dim]
        energy = (springs[own] * np.einsum("pad,pd->pa", frame[own], moved) ** 2).sum()
        assert motion @ found[block] @ motion == pytest.approx(energy, rel=1e-12)


def test_confined_rock_of_a_quarter_is_a_fifth_stiffer():
    """M = E (1 - nu) / ((1 + nu) (1 - 2 nu)): 60 GPa of 50."""
    rock = IntactRock(density=DENSITY, intact_modulus=5e10, intact_poisson=0.25)
    assert constrained_modulus(rock) == pytest.approx(6e10, rel=1e-14)


@st.composite
def partitions(draw):
    sets = [
        joint_set("a", draw(st.floats(5, 80)), spacing=draw(st.floats(1.0, 2.0))),
        joint_set("b", draw(st.floats(-80, -5)), spacing=draw(st.floats(1.0, 2.0))),
    ]
    if draw(st.booleans()):
        sets[1] = sets[1].model_copy(update={"ends_at": ["a"], "offset": 0.5})
    return sets


@given(sets=partitions(), ratio=st.floats(0.05, 2.0))
@settings(max_examples=25)
def test_critical_step_is_bounded_on_both_sides(sets, ratio):
    """Against scipy's eigenvalues of the whole system: bound <= 2 / omega <= sqrt(2) bound."""
    try:
        found = cut(Domain(size=[4.0, 3.0], least_width=1e-5, least_angle=0.0), sets)
    except GeometryError:  # joints that end at others may all miss so small a domain
        reject()
    points, weight = uniform(found, found.contacts, sets, ratio * NORMAL), masses_of(found)
    own, whole = block_stiffness(found.count, *points), assembled(found.count, [points])
    for k in range(found.count):
        np.testing.assert_allclose(
            own[k], whole[3 * k : 3 * k + 3, 3 * k : 3 * k + 3], rtol=1e-9, atol=1e-3
        )
    masses = weight.ravel()
    omega2 = eigh(whole, np.diag(masses), eigvals_only=True)
    least, exact = bound(own, weight), 2 / np.sqrt(omega2[-1])
    assert least <= exact * (1 + 1e-12) and exact <= 2**0.5 * least * (1 + 1e-12)
    assert (omega2[:3] < 1e-6 * omega2[-1]).all()  # three rigid motions of all blocks


@pytest.mark.parametrize("count", [1, 2])
def test_periodic_square_lattice_has_its_closed_form(count):
    """All frequencies of 6 x 4 squares against the dispersion relation of the lattice:

    D_uu = 2 k_n (1 - cos x) + 2 k_s (1 - cos y), D_uphi = -i k_s A sin y, D_vphi = i k_s A sin x,
    D_phiphi = k_s A^2 / 2 (2 + cos x + cos y) + 2 k_b (2 - cos x - cos y), k = K A, and k_b that
    of the points: K A^3 / 12 of two, 0 of one. A block held by its neighbours has 2 (k_n + k_s)
    and k_s A^2 + 4 k_b; where twice the former is the faster, the bound is exact, at x = y = pi.
    """
    side, (nx, ny) = 0.5, (6, 4)
    keys = {"spacing": side, "contact_points": count}
    sets = [joint_set("rows", 0.0, **keys), joint_set("columns", 90.0, **keys)]
    found = cut(Domain(size=[nx * side, ny * side]), sets)
    shifts = {"left": (nx * side, 0.0), "bottom": (0.0, ny * side)}
    parts = [(found.contacts, (0.0, 0.0))]
    parts += [(periodic_contacts(found, name, sets), shift) for name, shift in shifts.items()]
    pieces = [uniform(found, c, sets, shift=shift) for c, shift in parts]
    weight = masses_of(found)
    masses = weight.ravel()
    numbers = eigh(assembled(found.count, pieces), np.diag(masses), eigvals_only=True)

    kn, ks, kb = NORMAL * side, SHEAR * side, (count - 1) * NORMAL * side**3 / 12
    expected = []
    for p, q in product(range(nx), range(ny)):
        x, y = 2 * np.pi * p / nx, 2 * np.pi * q / ny
        cx, cy, up, vp = (
            np.cos(x),
            np.cos(y),
            -1j * ks * side * np.sin(y),
            1j * ks * side * np.sin(x),
        )
        uu, vv = (2 * a * (1 - cx) + 2 * b * (1 - cy) for a, b in ((kn, ks), (ks, kn)))
        turning = ks * side**2 / 2 * (2 + cx + cy) + 2 * kb * (2 - cx - cy)
        matrix = [[uu, 0, up], [0, vv, vp], [np.conj(up), np.conj(vp), turning]]
        expected += eigh(matrix, np.diag(masses[:3]), eigvals_only=True).tolist()
    np.testing.assert_allclose(numbers, np.sort(expected), rtol=1e-9, atol=1e-9 * numbers[-1])

    own = sum(block_stiffness(found.count, *piece) for piece in pieces)
    held = 2 * (kn + ks) / masses[0], (ks * side**2 + 4 * kb) / masses[2]
    assert bound(own, weight) == pytest.approx(2 / np.sqrt(2 * max(held)), rel=1e-12)
    if count == 1:
        assert bound(own, weight) == pytest.approx(2 / np.sqrt(numbers[-1]), rel=1e-12)

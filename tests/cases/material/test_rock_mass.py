"""Inertia, contact points and the critical step of blocks in the plane."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from jointwave.cases.geometry.cell_complex import GeometryError
from jointwave.cases.material.block_stiffness import block_stiffness, jump
from jointwave.cases.material.contact_points import contact_points, points_of
from jointwave.cases.material.rock_mass import Stiffness, constrained_modulus, inertia
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.plane import IntactRock
from tests.cases.partition.polygons import cut, periodic_contacts

DENSITY, NORMAL, SHEAR = 2500.0, 1.1e10, 4e9


def joint_set(name, dip, **keys):
    law = {"normal_stiffness": NORMAL, "shear_stiffness": SHEAR, "point_rule": "gauss"}
    return JointSet(name=name, dip=dip, **law | keys)


def assembled(count, pieces):
    """The stiffness matrix of all blocks [3 count, 3 count], spring by spring."""
    total = np.zeros((3 * count, 3 * count))
    for contacts, points, stiffness in pieces:
        normal = contacts.normal[points.contact]
        tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
        for along, k in ((normal, stiffness.normal), (tangent, stiffness.shear)):
            rows = [jump(along, points.arm[:, side]) for side in (0, 1)]
            for p, c in enumerate(points.contact):
                row = np.zeros(3 * count)
                for side, sign in ((0, -1), (1, 1)):
                    first = 3 * contacts.blocks[c, side]
                    row[first : first + 3] += sign * rows[side][p]
                total += k[c] * points.length[p] * np.outer(row, row)
    return total


def bound(own, weight):
    """Return the critical step that follows from blocks held by their neighbours, s."""
    scale = 1 / np.sqrt(np.stack([weight.mass, weight.mass, weight.moment], axis=1))
    largest = np.linalg.eigvalsh(scale[:, :, None] * own * scale[:, None, :]).max()
    return 2 / np.sqrt(2 * largest)


def uniform(contacts, normal=NORMAL, shear=SHEAR):
    return Stiffness(np.full(len(contacts), normal), np.full(len(contacts), shear))


def test_inertia_of_a_rectangle():
    """Mass rho b h, moment m (b^2 + h^2) / 12, per metre."""
    sets = [joint_set("flat", 0.0, spacing=1.0), joint_set("steep", 90.0, spacing=2.0)]
    found = inertia(cut(Domain(size=[4.0, 2.0]), sets), DENSITY)
    np.testing.assert_allclose(found.mass, 2 * DENSITY, rtol=1e-15)
    np.testing.assert_allclose(found.moment, 2 * DENSITY * 5 / 12, rtol=1e-14)


@pytest.mark.parametrize("count", range(1, 9))
def test_rules_integrate_what_they_should(count):
    """Gauss: polynomials up to degree 2 n - 1; midpoint: 1 - 1/n^2 of the bending stiffness."""
    x, w = points_of("gauss", count)
    for degree in range(2 * count):
        assert w @ x**degree == pytest.approx(1 / (degree + 1), rel=1e-13)
    x, w = points_of("midpoint", count)
    assert w @ (x - 0.5) ** 2 == pytest.approx((1 - 1 / count**2) / 12, abs=1e-15)


@given(a=st.floats(-80, 80), b=st.floats(-80, 80), count=st.integers(1, 4))
@settings(max_examples=30)
def test_points_carry_the_length_of_their_contacts(a, b, count):
    """Weights add up to the length, and their centre is the middle of the edge."""
    sets = [joint_set("a", a, spacing=1.0, contact_points=count), joint_set("b", b, spacing=1.5)]
    found = cut(Domain(size=[5.0, 4.0], slivers="merge", least_angle=0.0), sets)
    c = found.contacts
    points = contact_points(found, c, sets)
    length = np.bincount(points.contact, weights=points.length)
    np.testing.assert_allclose(length, c.area, rtol=1e-13)
    per_contact = np.bincount(points.contact)
    assert set(per_contact[c.joint_set == 0]) <= {count}
    for side in (0, 1):
        at = found.centroid[c.blocks[points.contact, side]] + points.arm[:, side]
        sums = [np.bincount(points.contact, weights=points.length * at[:, k]) for k in (0, 1)]
        middle = (c.start + c.end) / 2
        np.testing.assert_allclose(np.stack(sums, 1) / length[:, None], middle, atol=1e-9)


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
    stiffness, weight = uniform(found.contacts, shear=ratio * NORMAL), inertia(found, DENSITY)
    points = contact_points(found, found.contacts, sets)
    own = block_stiffness(
        found.count, found.contacts.blocks, found.contacts.normal, points, stiffness
    )
    whole = assembled(found.count, [(found.contacts, points, stiffness)])
    for k in range(found.count):
        np.testing.assert_allclose(
            own[k], whole[3 * k : 3 * k + 3, 3 * k : 3 * k + 3], rtol=1e-9, atol=1e-3
        )
    masses = np.stack([weight.mass, weight.mass, weight.moment], axis=1).ravel()
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
    parts += [(periodic_contacts(found, name), shift) for name, shift in shifts.items()]
    pieces = [(c, contact_points(found, c, sets, shift), uniform(c)) for c, shift in parts]
    weight = inertia(found, DENSITY)
    masses = np.stack([weight.mass, weight.mass, weight.moment], axis=1).ravel()
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

    own = sum(block_stiffness(found.count, c.blocks, c.normal, *rest) for c, *rest in pieces)
    held = 2 * (kn + ks) / masses[0], (ks * side**2 + 4 * kb) / masses[2]
    assert bound(own, weight) == pytest.approx(2 / np.sqrt(2 * max(held)), rel=1e-12)
    if count == 1:
        assert bound(own, weight) == pytest.approx(2 / np.sqrt(numbers[-1]), rel=1e-12)

"""Forces, tangents and energies of joints at their points, by the law of one, as plain Python.

Jumps are of 0.1 mm: open and closed points, ones that slip and ones that stick.
"""

import numpy as np
import pytest

from jointwave.continuum.space.tractions import joint_energy, joint_loads, joint_tangents
from jointwave.joints.dilation import lift
from jointwave.joints.energy import fracture_energy_spent
from jointwave.joints.law import History, Law, law_of, parts_of, table_of, traction

POINTS, DT, RATE, PRESTRESS = 12, 1e-3, 2e3, (3e4, 5e3, -2e3)
HELD = {"normal_stiffness": 1e9, "shear_stiffness": 4e8}
DAMPED = {"normal_viscosity": 1e5, "shear_viscosity": 4e4}
SLIPS = {"cohesion": 1e4, "friction": 0.4}
WEAKENS = {"dynamic_friction": 0.1, "weakening_distance": 5e-5}
DILATES = {"dilation": 0.1, "dilation_distance": 8e-5}
RATED = {"direct_effect": 0.01, "evolution_effect": 0.015, "critical_slip_distance": 1e-3}
RATED |= {"reference_rate": 1e-6, "initial_state": 10.0}
BREAKS = {"tensile_strength": 3e4, "critical_opening": 2e-4}
LAWS = {
    "elastic": HELD,
    "damped": HELD | DAMPED,
    "slips": HELD | SLIPS,
    "slips, damped": HELD | SLIPS | DAMPED,
    "no tension": HELD | {"carries_tension": False},
    "weakens": HELD | SLIPS | WEAKENS,
    "weakens, damped": HELD | DAMPED | SLIPS | WEAKENS,
    "rate and state": HELD | SLIPS | RATED,
    "rate and state, damped": HELD | DAMPED | SLIPS | RATED,
    "dilates": HELD | SLIPS | DILATES,
    "dilates, weakens, damped": HELD | DAMPED | SLIPS | WEAKENS | DILATES,
    "softens, damped": HELD | DAMPED | SLIPS | BREAKS | {"residual_cohesion": 2e3},
}
laws = pytest.mark.parametrize("given", LAWS.values(), ids=LAWS)
directions = pytest.mark.parametrize("directions", [1, 2, 3])
prestress = pytest.mark.parametrize("prestress", [None, PRESTRESS], ids=["", "prestressed"])


class Points:
    """Points of joints whose law varies, with their jumps and what they remember."""

    def __init__(self, given, directions, prestress):
        random = np.random.default_rng(7)
        if directions == 1:
            away = ("shear_stiffness", "shear_viscosity", "cohesion", "friction")
            away += ("residual_cohesion", "dynamic_friction", "weakening_distance")
            away += ("dilation", "dilation_distance", *RATED)
            given = {k: v for k, v in given.items() if k not in away}
        stiffness = given["normal_stiffness"] * random.uniform(1, 2, POINTS)
        self.law = Law(**given | {"normal_stiffness": stiffness})
        self.parts, self.table = parts_of(self.law), table_of(self.law)
        self.directions, self.prestress = directions, None
        if prestress is not None:
            along = np.array(prestress[:directions])
            self.prestress = along[:, None] * random.uniform(1, 2, POINTS)
        self.shears = True if directions > 1 else None
        self.area = random.uniform(0.1, 0.3, POINTS)
        shape = directions, POINTS
        self.jump, self.slip_rate = random.uniform(-1e-4, 1e-4, (2, *shape))
        self.slip_rate /= DT
        rest = random.uniform(-1e-2, 1e-2, shape)
        # As implicit steps see it: a rate that goes with the jump.
        self.rate_at = (
            (lambda jump: RATE * jump + rest) if self.parts.dashpots else lambda jump: None
        )
        self.opening = random.uniform(0, 1e-4, POINTS) if self.parts.softening else None
        shear = self.shears is not None and self.parts.limited
        self.slide = random.uniform(-5e-5, 5e-5, (directions - 1, POINTS)) if shear else None
        cohesion = shear and self.parts.residual
        self.cohesion = random.uniform(5e3, 1e4, POINTS) if cohesion else None
        self.path = random.uniform(0, 6e-5, POINTS) if self.parts.path else None

    @property
    def common(self):
        return self.parts, self.directions, self.shears, self.table, self.area, self.prestress

    def carried(self, q):
        """Return what of its tractions a point carries at rest [directions], Pa; along the joint
        nothing where the law has no slide that it could begin with."""
        found = np.zeros(self.directions) if self.prestress is None else self.prestress[:, q].copy()
        found[1:] *= self.slide is not None
        return found

    @property
    def history(self):
        found = self.opening, self.slide, self.cohesion, self.path
        return [None if part is None else part.copy() for part in found]

    def loads(self, jump):
        """Return loads, drags (None without dashpots), history and the work of sliding."""
        history, loads = self.history, np.full(jump.shape, np.nan)
        drags = np.full(jump.shape, np.nan) if self.parts.dashpots else None
        rate = self.rate_at(jump)
        work = joint_loads(
            *self.common, jump, rate, self.slip_rate, *history, loads, drags, DT
        )  # fmt: skip
        return loads, drags, history, work

    def by_law(self, q, jump):
        """Return tractions [3] (Pa) and history of a point by the law of one, for a whole jump."""
        law, gap = law_of(self.table, q), jump[0, q]
        if self.prestress is not None:
            gap -= self.prestress[0, q] / law.normal_stiffness
        slip, moved, rate = np.zeros(2), np.zeros(2), np.zeros(3)
        slip[: self.directions - 1] = jump[1:, q]
        if self.slide is not None:
            slip[: self.directions - 1] -= self.slide[:, q]
            moved[: self.directions - 1] = DT * self.slip_rate[1:, q]
        if self.parts.dashpots:
            rate[: self.directions] = self.rate_at(jump)[:, q]
        old = slip - moved
        opening = gap if self.opening is None else self.opening[q]
        cohesion = 0.0 if self.cohesion is None else self.cohesion[q]
        path = 0.0 if self.path is None else self.path[q]
        before = History(opening, old[0], old[1], cohesion, path)
        *t, after = traction(law, self.parts, gap, rate[0], moved, rate[1:], DT, before)
        return np.array(t), after


@laws
@directions
@prestress
def test_forces_are_those_of_the_law_at_every_point(given, directions, prestress):
    """Areas times tractions, less what the prestress carries; slides are what is not elastic."""
    points = Points(given, directions, prestress)
    loads, drags, (opening, slide, cohesion, path), _ = points.loads(points.jump)
    whole = loads if drags is None else loads + drags
    slipped = 0
    for q in range(POINTS):
        t, after = points.by_law(q, points.jump)
        expected = points.area[q] * (t[:directions] - points.carried(q))
        np.testing.assert_allclose(whole[:, q], expected, rtol=1e-12, atol=1e-8)
        if opening is not None:
            assert opening[q] == after.opening
        if slide is not None:
            elastic = np.array([after.ex, after.ez])[: directions - 1]
            np.testing.assert_allclose(points.jump[1:, q] - slide[:, q], elastic, atol=1e-18)
            slipped += (slide[:, q] != points.slide[:, q]).any()
        if cohesion is not None:
            assert cohesion[q] == after.cohesion
        if path is not None:
            np.testing.assert_allclose(path[q], after.path, rtol=1e-11)
    if points.slide is not None:
        assert 0 < slipped < POINTS or "carries_tension" in given


@laws
@directions
@prestress
def test_tangents_are_the_slopes_of_the_forces(given, directions, prestress):
    """Central differences of 1e-10 m, of forces of 1e4 N: round-off of some 1e-6 of a tangent, and
    the curvature of what slips about as little."""
    points = Points(given, directions, prestress)
    found = np.zeros((8 if points.parts.dilation else 6, POINTS))
    points.slip_rate[:] = 0.0  # what the step adds is in the jump
    rate = points.rate_at(points.jump)
    joint_tangents(*points.common, points.jump, rate, *points.history, DT, RATE, found)
    nn, xn, zn, xx, xz, zz, nx, nz = (*found, 0 * found[0], 0 * found[0])[:8]
    whole = np.array([[nn, nx, nz], [xn, xx, xz], [zn, xz, zz]])[:directions, :directions]
    for d in range(directions):
        forces = []
        for size in (1e-10, -1e-10):
            jump = points.jump.copy()
            jump[d] += size
            loads, drags, *_ = points.loads(jump)
            forces.append(loads if drags is None else loads + drags)
        slope = -(forces[0] - forces[1]) / 2e-10
        assert np.abs(whole[:, d] - slope).max() < 2e-5 * np.abs(whole).max()


@laws
@directions
@prestress
def test_energy_is_what_springs_hold_and_cracks_have_spent(given, directions, prestress):
    """Half of what a joint carries in all times its elastic length, from where it carries nothing;
    and p u, what the prestress p of the rock around it gains where its faces move apart by u."""
    points = Points(given, directions, prestress)
    loads, _, (opening, slide, _, path), _ = points.loads(points.jump)
    stored, spent = joint_energy(
        points.parts, directions, points.table, points.area, points.prestress, points.jump,
        opening, slide, path, loads,
    )  # fmt: skip
    expected, cracks = 0.0, 0.0
    for q in range(POINTS):
        law, area = law_of(points.table, q), points.area[q]
        p, jump = points.carried(q), points.jump[:, q]
        length = jump.copy()
        length[0] -= p[0] / law.normal_stiffness
        if points.parts.dilation:
            length[0] -= lift(law, path[q])
        if slide is not None:
            length[1:] -= slide[:, q]
        expected += area * p @ jump - (loads[:, q] + area * p) @ length / 2
        if opening is not None:
            cracks += area * fracture_energy_spent(law, opening[q])
    assert stored == pytest.approx(expected, rel=1e-12)
    assert spent == pytest.approx(cracks, rel=1e-12)
    assert (spent > 0) == ("tensile_strength" in given)


@pytest.mark.parametrize("directions", [2, 3])
def test_sliding_takes_the_work_of_the_strength_over_the_slide(directions):
    """Points that yield at the cohesion c slide on along the traction: A c times the way."""
    points = Points(HELD | {"cohesion": 1e4, "friction": 0.0}, directions, None)
    points.slide[:] = points.jump[1:]
    points.jump[1:] += 1e4 / 4e8 / np.sqrt(directions - 1)  # the elastic slip that c holds
    points.jump[1:] += 1e-4
    points.slip_rate[1:] = 1e-4 / DT
    *_, work = points.loads(points.jump)
    way = np.sqrt(directions - 1) * 1e-4
    assert work == pytest.approx(1e4 * points.area.sum() * way, rel=1e-9)

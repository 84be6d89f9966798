"""Orders of convergence, and which points no other beats."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compare.engines import applies
from compare.experiments.study.findings import (
    cheapest,
    digits_per_second,
    floor,
    front,
    judged,
    orders,
)
from compare.experiments.study.measure import PointRow, method_applies
from compare.experiments.study.reference import finest_of, own_of
from compare.experiments.study.study import FineRun, load, shipped
from compare.experiments.study.summary import run


def row(**numbers):
    """Return a row that was done, with these numbers."""
    empty = dict.fromkeys(PointRow._fields, float("nan"))
    return PointRow(**(empty | {"curve": "a", "settings": {}, "state": "done"} | numbers))


def test_leapfrog_is_of_second_order(study, tmp_path):
    (order,) = orders(study(), run(study(), tmp_path))
    assert order.measured == pytest.approx(2, abs=0.05) and order.theory == 2


def test_order_is_that_of_the_errors(study):
    """Errors h^3 of a key that grows as they fall, a failed point between them."""
    vary = {"numerics.continuum.elements_per_block": [1, 2, 3, 4]}
    curve = {"label": "a", "method": "dem", "own": "lattice", "order": 3, "vary": vary}
    rows = [
        row(settings={"numerics.continuum.elements_per_block": n}, numerical=1e-3 / n**3)
        for n in (1, 2, 4)
    ]
    rows.append(row(state="failed", settings={"numerics.continuum.elements_per_block": 3}))
    (order,) = orders(study([curve]), rows)
    assert order.steps == pytest.approx([3, 3])


def test_no_order_where_none_is_claimed_or_nothing_falls(study):
    curve = {"label": "a", "method": "dem", "vary": {"pillar.block": [0.5, 0.25]}}
    rows = [row(settings={"pillar.block": d}, numerical=d) for d in (0.5, 0.25)]
    assert orders(study([curve]), rows) == []
    curve = curve | {"own": "lattice", "order": 1}
    assert len(orders(study([curve]), rows)) == 1
    assert orders(study([curve]), [r._replace(numerical=1e-15) for r in rows]) == []


def test_the_front_is_what_no_other_point_beats():
    costs, errors = [1, 2, 3, 4, 5, 5], [0.5, 0.7, 0.1, 0.1, 0.01, 0.02]
    rows = [
        row(total=e, seconds=float(c), total_floor=0.0, curve=f"{c} {e}")
        for c, e in zip(costs, errors, strict=True)
    ]
    rows.append(row(total=1e-9, seconds=0.1, state="failed"))
    assert [(r.seconds, r.total) for r in front(rows)] == [(1, 0.5), (3, 0.1), (5, 0.01)]
    found = [(c.misfit, c.row.seconds, c.next_best.seconds) for c in cheapest(rows[:-2])[:1]]
    assert found == [(0.1, 3, 4)]
    assert [(c.misfit, c.row.seconds) for c in cheapest(rows)] == [(0.1, 3), (0.01, 5)]
    assert digits_per_second(judged(rows)[4]) == pytest.approx(2 / 5)


@settings(max_examples=25)
@given(st.lists(st.tuples(st.floats(1e-6, 1.0), st.floats(0, 1e-3)), min_size=1, max_size=8))
def test_a_point_counts_for_what_all_finer_points_hold(errors):
    """Whatever the errors, and in whatever order the points stand."""
    rows = [
        row(total=e + floor, total_floor=floor, freedoms=10.0, steps=float(n), seconds=float(n + 1))
        for n, (e, floor) in enumerate(errors)
    ]
    found = judged(rows)
    for i, one in enumerate(found):
        assert one.held == max(r.total for r in found[i:])
    assert sorted(judged(rows[::-1]), key=lambda r: r.steps) == sorted(found, key=lambda r: r.steps)
    for target in cheapest(rows):
        finer = [r for r in rows if r.steps >= target.row.steps]
        assert all(r.total <= target.misfit for r in finer)
        assert 10 * target.row.total_floor <= target.misfit


def test_points_of_other_physics_or_of_more_elements_in_fewer_steps_are_not_finer():
    damped, free = ({"joints.damping_ratio": z} for z in (0.1, 0.0))
    rows = [
        row(total=0.1, freedoms=1.0, steps=1.0, settings=damped),
        row(total=0.2, freedoms=1.0, steps=2.0, settings=free),
        row(total=0.3, freedoms=9.0, steps=1.0, settings=free),
    ]
    assert [r.held for r in judged(rows)] == [0.1, 0.2, 0.3]


#: The studies that claim an order; the others have corners in their motion.
CLAIMING = [name for name in shipped() if any(curve.order for curve in load(name).curves)]


#: The study with all engines and schemes, on a pillar that is a tenth as long.
CUT = {"pillar.length": 5.0, "record.stress": [2.0], "time.duration": 0.03}


@pytest.mark.parametrize(
    ("name", "cut"),
    [("free-pillar", CUT), *(pytest.param(n, {}, marks=pytest.mark.slow) for n in CLAIMING)],
)
def test_shipped_orders_are_within_a_tenth_of_theory(name, cut, tmp_path):
    """Every order that a study claims, by counts and errors alone: blocks in size and step, rock in
    elements and step, explicit and implicit."""
    study = load(name)
    curves = tuple(curve for curve in study.curves if curve.order is not None)
    alone = {"curves": curves, "timed": False, "finest": "none"}
    study = study.model_copy(update=alone | {"changes": study.changes | cut})
    found = orders(study, run(study, tmp_path))
    assert [order.curve for order in found] == [curve.label for curve in curves]
    for order in found:
        assert order.measured == pytest.approx(order.theory, abs=0.1), order.curve


def test_orders_are_those_of_rock_in_both_models_and_of_blocks():
    """The claims of the convergence study: none is omitted unnoticed."""
    claims = {curve.label: curve.order for curve in load("convergence").curves}
    for p in (1, 2, 3, 4):
        for model in ("jointed rock", "homogenised bar"):
            assert claims[f"{model}, elements of order {p}"] == p + 1
            assert claims[f"{model}, explicit step"] == claims[f"{model}, implicit step"] == 2
    assert [order for label, order in claims.items() if "rigid" in label] == [2, 4, 2]


def test_a_smaller_step_is_worse_on_the_uniform_chain(tmp_path):
    """At c dt = d the error is round-off over some hundred steps; then it only grows."""
    study = load("uniform-chain")
    errors = [row.numerical for row in run(study, tmp_path)]
    assert errors[0] < 1e-12
    assert errors[1:] == sorted(errors[1:]) and errors[1] > 0.01


@pytest.mark.parametrize("name", shipped())
def test_every_point_of_shipped_studies_can_be_run(name):
    """Its scene holds together, and its method and all that errors are measured against apply."""
    study, held = load(name), set()
    for point in study.points():
        assert (answer := method_applies(point, point.scene)), (point.settings, answer.reason)
        own, finest = own_of(point), finest_of(study)
        assert own is not None
        for against, physics in ((own, point.physics), (finest, {})):
            if (key := repr((against, physics))) in held:
                continue
            held.add(key)
            if isinstance(against, FineRun):
                for changes in (against.changes, against.changes | against.coarser):
                    assert applies(against.method, study.changed(physics | changes))
            elif against is not None:
                assert applies(against, study.changed(physics))


def test_an_order_is_not_read_off_errors_that_are_not_known(study):
    """Errors h^2 down to half a percent of the floor's tenfold: those below are left out."""
    curve = {"label": "a", "method": "dem", "order": 2, "vary": {"pillar.block": [4, 2, 1, 0.5]}}
    rows = [
        row(settings={"pillar.block": d}, numerical=1e-3 * d**2, numerical_floor=5e-5)
        for d in (4, 2, 1, 0.5)
    ]
    (order,) = orders(study([curve]), rows)
    assert order.steps == pytest.approx([2, 2])


def test_no_point_is_the_cheapest_within_a_misfit_that_is_not_known():
    """The reference of errors must be known to a tenth of the misfit."""
    points = [("a", 0.05), ("b", 1e-4)]
    rows = [row(total=e, total_floor=3e-3, seconds=1.0, curve=name) for name, e in points]
    assert [c.misfit for c in cheapest(rows)] == [0.1]
    assert [c.misfit for c in cheapest([r._replace(total_floor=0.0) for r in rows])][-1] == 1e-4


def test_the_floor_of_totals_is_that_of_the_finest_physics():
    """Not what is not known of a coarser model's own run; of the finest curve, its own."""
    known = row(total_floor=0.004, numerical_floor=0.004)
    coarse = row(total_floor=0.104, numerical_floor=0.1)
    assert floor([known, coarse], "total") == pytest.approx(0.004)
    assert floor([known], "total") == 0.004
    assert floor([known, coarse], "numerical") == 0.1

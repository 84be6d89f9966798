"""Orders of convergence, and which points no other beats."""

import pytest

from compare.studies.measure import Row
from compare.studies.orders import orders
from compare.studies.pareto import cheapest, digits_per_second, front
from compare.studies.runner import run
from compare.studies.study import load, shipped


def row(**numbers):
    """Return a row that was done, with these numbers."""
    empty = dict.fromkeys(Row._fields, float("nan"))
    return Row(**(empty | {"curve": "a", "settings": {}, "state": "done"} | numbers))


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
    rows = [row(total=e, seconds=float(c)) for c, e in zip(costs, errors, strict=True)]
    rows.append(row(total=1e-9, seconds=0.1, state="failed"))
    assert [(r.seconds, r.total) for r in front(rows)] == [(1, 0.5), (3, 0.1), (5, 0.01)]
    assert [(c.misfit, c.row.seconds) for c in cheapest(rows)] == [(0.1, 3), (0.01, 5)]
    assert digits_per_second(rows[4]) == pytest.approx(2 / 5)


def test_shipped_convergence_is_within_a_tenth_of_theory(tmp_path):
    """Every order that the study claims, blocks in size and step, rock in elements and step."""
    study = load("convergence")
    found = orders(study, run(study, tmp_path))
    assert len(found) == sum(curve.order is not None for curve in study.curves) >= 4
    for order in found:
        assert order.measured == pytest.approx(order.theory, abs=0.1), order.curve


def test_a_smaller_step_is_worse_on_the_uniform_chain(tmp_path):
    """At c dt = d the error is round-off over some hundred steps; then it only grows."""
    study = load("uniform-chain")
    errors = [row.numerical for row in run(study, tmp_path)]
    assert errors[0] < 1e-12
    assert errors[1:] == sorted(errors[1:]) and errors[1] > 0.01


@pytest.mark.parametrize("name", shipped())
def test_every_point_of_shipped_studies_is_a_scene(name):
    assert all(point.scene.record.interval for point in load(name).points())

"""Which error of a point counts, orders of convergence, and sentences with their numbers."""

import pytest

from jointwave.compare.studies.findings import TARGETS, cheapest, floor, judged, orders, sentences
from jointwave.compare.studies.study import load, shipped
from jointwave.compare.studies.work_precision import experiment


def row(**numbers):
    about = {"curve": "a", "method": "dem", "settings": {}, "state": "done", "message": ""}
    return about | numbers


def test_order_is_that_of_the_errors_that_are_known(study):
    """Errors h^2 or h^3 of a size, or of a key that grows as they fall, a failed point between
    them; those below ten times the floor and round-off are left out."""

    def order(key, values, size, power, order, failed=None, **about):
        curve = {"label": "a", "method": "dem", "order": order, "vary": {key: values}}
        rows = [row(settings={key: v}, numerical=1e-3 * size(v) ** power, **about) for v in values]
        rows += [] if failed is None else [row(state="failed", settings={key: failed})]
        return [one.measured for one in orders(study([curve]), judged(rows))]

    count, inverse = "numerics.continuum.elements_per_block", lambda n: 1 / n
    assert order(count, [1, 2, 4], inverse, 3, order=3, failed=3) == pytest.approx([3])
    sizes = "pillar.block", [4, 2, 1, 0.5], float, 2
    assert order(*sizes, order=2, numerical_floor=5e-5) == pytest.approx([2])
    assert order(*sizes, order=None, numerical_floor=5e-5) == []
    assert order("pillar.block", [4, 2], lambda d: 1e-6 * d, 2, order=2) == []


def test_a_point_counts_for_what_all_finer_ones_hold():
    """Whatever the order of the rows. Points of other physics are not finer, and those without work
    are in their order."""
    damped, free = ({"joints.damping_ratio": z} for z in (0.1, 0.0))
    rows = [
        *(row(total=e, work=k) for k, e in enumerate((0.05, 0.02, 0.03, 0.005))),
        row(total=0.1, work=1.0, settings=damped),
        row(total=0.2, work=2.0, settings=free),
    ]
    held = [0.05, 0.03, 0.03, 0.005, 0.1, 0.2]
    assert list(judged(rows)["held"]) == held and list(judged(rows[::-1])["held"]) == held[::-1]
    series = [row(total=e, settings={"numerics.a": n}) for e, n in ((0.1, 9), (0.3, 18))]
    assert list(judged(series)["held"]) == [0.3, 0.3]


def test_no_point_is_the_cheapest_within_a_misfit_that_is_not_known():
    """The reference of errors must be known to a tenth of the misfit."""
    points = [("a", 0.05), ("b", 1e-4)]
    rows = [row(total=e, total_floor=3e-3, seconds=1.0, curve=name) for name, e in points]
    assert [len(cheapest(judged(rows), target)) for target in TARGETS] == [2, 0, 0, 0]
    known = [one | {"total_floor": 0.0} for one in rows]
    assert list(cheapest(judged(known), 1e-4).curve) == ["b"]


def test_the_floor_of_totals_is_that_of_the_finest_physics():
    """Not what is not known of a coarser model's own run; of the finest curve, its own."""
    known = row(total_floor=0.004, numerical_floor=0.004)
    coarse = row(total_floor=0.104, numerical_floor=0.1)
    assert floor(judged([known, coarse]), "total") == pytest.approx(0.004)
    assert floor(judged([known]), "total") == 0.004
    assert floor(judged([known, coarse]), "numerical") == 0.1


def test_points_with_equal_time_steps_are_named(study):
    key = "numerics.dem.step_fraction"
    rows = [row(settings={key: v}, dt=dt) for v, dt in ((0.1, 1e-5), (0.11, 1e-5), (0.2, 2e-5))]
    curve = {"label": "a", "method": "dem", "vary": {key: [0.1, 0.11, 0.2]}}
    (line,) = sentences(study([curve]), judged(rows))
    assert line.startswith(f"a: 2 of 3 points have the time step of another one: {key} is rounded")
    assert not sentences(study([curve]), judged(rows[1:]))


def test_sentences_hold_for_their_numbers(study):
    """The next best within the same misfit, not the most expensive."""
    numbers = zip((0.05, 0.02, 0.005, 0.004, 0.003), (1, 2, 4, 12.0, 900.0), "ababc", strict=True)
    parts = {"modelling": 0.001, "total_floor": 0.0}
    rows = [
        row(curve=name, total=e, numerical=e - 0.001, seconds=cost, work=1 / e, **parts)
        for e, cost, name in numbers
    ]
    one, two = sentences(study(timed=True, finest="lattice"), judged(rows))
    assert one.startswith("Within 10.0 %") and one.endswith("steps 2 times as long.")
    assert "a (numerical 4.90 % + modelling 0.100 % = 5.00 %; 1 s)" in one
    assert "cheapest is a (numerical 0.400 %" in two and two.endswith("steps 3 times as long.")
    assert sentences(study(), judged(rows)) == []


def test_a_headline_by_cancellation_is_marked_and_not_counted(tmp_path):
    """The free pillar's blocks at 7.1, 2.1, 0.96, 1.7, 1.9, 1.95 % from jointed rock: their model
    is 1.97 % off, so that no step is within 1 %, nor the most accurate one within 1.95 %."""
    pillar = load("free-pillar")
    blocks = pillar.model_copy(update={"curves": pillar.curves[:1], "repeats": 1})
    table = judged(experiment(blocks, tmp_path).rows())
    assert list(100 * table.measured) == pytest.approx([7.1, 2.1, 0.96, 1.7, 1.9, 1.95], 0.02)
    assert list(100 * table.modelling) == pytest.approx([1.97] * 6, rel=0.01)
    assert [len(cheapest(table, target)) for target in TARGETS] == [1, 0, 0, 0]
    assert list(table.cancels) == [True, True, True, True, False, False]
    assert table.held[2] == pytest.approx(0.0298, rel=0.01)
    said = " ".join(sentences(blocks, table))
    assert "Within 1.00 %" not in said and "no other curve reaches it" in said


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
    found = orders(study, judged(experiment(study, tmp_path).rows()))
    assert [order.curve for order in found] == [curve.label for curve in curves]
    for order in found:
        assert order.measured == pytest.approx(order.theory, abs=0.1), order.curve


def test_a_smaller_step_is_worse_on_the_uniform_chain(tmp_path):
    """At c dt = d the error is round-off over some hundred steps; then it only grows."""
    study = load("uniform-chain")
    found = [one["numerical"] for one in experiment(study, tmp_path).rows()]
    assert found[0] < 1e-12
    assert found[1:] == sorted(found[1:]) and found[1] > 0.01

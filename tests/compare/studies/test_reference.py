"""Fine runs that stand for exact solutions, and how well they are known."""

import pytest

from compare.engines import solve
from compare.metrics import misfit
from compare.studies.findings import sentences
from compare.studies.measure import measure
from compare.studies.orders import orders
from compare.studies.runner import run

STEP = "numerics.dem.step_fraction"
FINE = {"method": "dem", "changes": {STEP: 0.01}, "coarser": {STEP: 0.02}}


def fine(study, **keys):
    """Return the study of rigid blocks, measured against their own fine run."""
    curve = {"label": "blocks", "method": "dem", "own": "finest", "order": 2}
    vary = {STEP: [0.4, 0.2]}
    return study([curve | {"vary": vary}], finest=FINE, **keys)


def test_the_floor_is_how_far_the_coarser_run_is_from_the_finer(study):
    """And bounds the finer run's own error: leapfrog of second order, it is a third of that."""
    asked = fine(study)
    row = measure(asked.points()[0])
    runs = [solve("dem", asked.changed({STEP: f})) for f in (0.01, 0.02, 0.4)]
    exact = solve("lattice", asked.base)
    assert row.total_floor == row.numerical_floor == misfit(runs[1], runs[0])
    assert row.total == row.numerical == misfit(runs[2], runs[0])
    assert misfit(runs[0], exact) < row.total_floor < 4 * misfit(runs[0], exact)


def test_errors_against_a_fine_run_are_nearly_those_against_the_exact_solution(study, tmp_path):
    asked = fine(study)
    exact = study([asked.curves[0].model_dump() | {"own": "lattice"}])
    pairs = zip(run(asked, tmp_path), run(exact, tmp_path), strict=True)
    for one, other in pairs:
        assert one.numerical == pytest.approx(other.numerical, rel=0.02)
        assert other.numerical_floor == 0.0
    (order,) = orders(asked, run(asked, tmp_path))
    assert order.measured == pytest.approx(2, abs=0.1)


def test_a_fine_run_follows_the_curve_in_its_physics_and_not_in_its_numerics(study):
    curve = {"label": "blocks", "method": "dem", "own": FINE}
    curve |= {"changes": {"pillar.block": 0.25, STEP: 0.4}}
    asked = study([curve])
    row = measure(asked.points()[0])
    found, exact = (
        solve("dem", asked.changed({"pillar.block": 0.25, STEP: f})) for f in (0.4, 0.01)
    )
    assert row.numerical == misfit(found, exact)


def test_sentences_say_how_well_the_finest_physics_is_known(study, tmp_path):
    asked = fine(study, timed=True, repeats=1)
    said = sentences(asked, run(asked, tmp_path))
    assert said[-1].startswith("The finest physics is a fine run of dem; a coarser one is 0.0")

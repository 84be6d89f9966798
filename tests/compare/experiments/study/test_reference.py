"""Fine runs that replace exact solutions, and their accuracy."""

import numpy as np
import pytest

from compare.engines import solve
from compare.experiments.study.findings import orders, sentences
from compare.experiments.study.measure import measure
from compare.experiments.study.reference import finest_of, own_of
from compare.experiments.study.summary import run
from compare.misfit.metrics import misfit, pairings

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
    assert row.measured == row.numerical == misfit(runs[2], runs[0]) and row.modelling == 0
    assert row.total == row.numerical + row.numerical_floor
    assert misfit(runs[0], exact) < row.total_floor < 4 * misfit(runs[0], exact)


def test_errors_against_a_fine_run_are_nearly_those_against_the_exact_solution(study, tmp_path):
    asked = fine(study)
    exact = study([asked.curves[0].model_dump() | {"own": "lattice"}])
    pairs = zip(run(asked, tmp_path), run(exact, tmp_path), strict=True)
    for one, other in pairs:
        assert one.numerical == pytest.approx(other.numerical, rel=0.02)
        assert 0 < other.numerical_floor < 1e-11  # a matrix exponential knows its round-off
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


def test_errors_are_measured_by_the_one_ranking(study):
    """Where the file is silent: own model and finest physics, of what applies to the scene."""
    curves = [
        {"label": name, "method": name}
        for name in ("dem", "solve-ivp", "continuum-jointed", "continuum-equivalent", "series")
    ]
    asked = study(curves)
    assert finest_of(asked) == "jointed-bar"
    owns = [own_of(point) for point in asked.points()]
    assert owns == ["lattice", "lattice", "jointed-bar", "images", "images"]
    assert finest_of(study(finest="none")) is None
    soft = study(changes=study().changes | {"joints.tension": False})
    assert finest_of(soft) is None  # jointed rock, of which no exact solution holds
    stiff = {"rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0}}
    assert finest_of(study(changes=study().changes | stiff)) == "lattice"


def test_a_fine_run_of_one_model_of_the_rock_stands_for_that_of_the_other(study):
    """At the same numerics; blocks have others."""
    numerics = {"changes": {"numerics.continuum.order": 4}, "coarser": {"pillar.block": 0.5}}
    names = ("continuum-jointed", "continuum-equivalent", "dem")
    asked = study(
        [{"label": name, "method": name} for name in names],
        finest={"method": "continuum-jointed", **numerics},
        changes=study().changes | {"joints.friction_angle": 30.0, "load.direction": [1, 0, 0]},
    )
    rock, homogenised, blocks = (own_of(point) for point in asked.points())
    assert rock == asked.finest and blocks is None
    assert homogenised == rock.model_copy(update={"method": "continuum-equivalent"})


def test_modelling_error_is_that_of_the_own_model_whatever_the_step(study):
    asked = study(finest="jointed-bar")
    rows = [measure(point) for point in asked.points()[:2]]
    lattice, rock = (solve(name, asked.base) for name in ("lattice", "jointed-bar"))
    assert [row.modelling for row in rows] == [misfit(lattice, rock)] * 2
    for row in rows:
        assert row.total == row.numerical + row.modelling + row.total_floor
        assert row.numerical_floor < row.total_floor < 1e-4  # bars have an error of 1e-8 inside
    assert rows[0].measured == misfit(solve("dem", asked.points()[0].scene), rock)


def test_an_error_is_that_of_the_waveform_furthest_off_or_of_one_quantity_in_space(study):
    """Receivers are pooled only where a study asks for the norm that orders are of in theory."""
    places = study().changes | {"record.stress": [0.5, 2.0], "record.velocity": [1.0, 5.0]}
    asked = study(changes=places)
    one, other = solve("dem", asked.points()[0].scene), solve("lattice", asked.base)
    pairs = pairings(one, other)
    assert measure(asked.points()[0]).numerical == max(p.misfit for p in pairs)
    of = [p for p in pairs if p.place.quantity == "velocity"]
    off = sum(np.sum((p.one - p.other) ** 2) for p in of)
    size = sum(np.sum(p.other**2) for p in of)
    row = measure(study(changes=places, quantity="velocity").points()[0])
    assert len(of) == 2 and row.numerical == pytest.approx(np.sqrt(off / size))


def test_sentences_say_how_well_the_finest_physics_is_known(study, tmp_path):
    asked = fine(study, timed=True, repeats=1)
    said = sentences(asked, run(asked, tmp_path))
    assert said[-1].startswith("The finest physics is a fine run of dem; a coarser one is 0.0")

"""All pictures of a rock mass: a panel for each component that moves at each receiver."""

import pytest

from jointwave.cases.read import load_tables
from jointwave.compare.figures.receivers import curve_table, panels
from jointwave.compare.figures.scene_figures import figures_of
from jointwave.compare.figures.tables import distance_frame
from jointwave.compare.misfit.pairs import measure
from jointwave.compare.report.tables import misfit_table


@pytest.fixture
def solved(compared, one_joint):
    """Return a function that solves the scene, for each dip of its joint (degrees), by formulas."""

    def solve(*dips):
        tables = one_joint(
            domain={"size": [20.0, 20.0]},
            time={"duration": 0.02},
            record={"points": [[10.0, 5.0]], "joints": [[10.0, 10.0]], "interval": 1e-4},
        )
        (joint,) = tables["joint_sets"]
        joint["through"] = [10.0, 10.0]
        scenes = [load_tables(tables | {"joint_sets": [joint | {"dip": dip}]}) for dip in dips]
        return compared(*scenes, by=("oblique-joint", "parallel-joints"))

    return solve


def test_a_panel_shows_a_component_that_moves(solved):
    """At a level joint a wave that travels upwards moves nothing sideways."""
    oblique, level = panels(solved(30.0, 0.0))
    assert [panel.place.heading for panel in oblique] == [
        "velocity x at [10, 5] m",
        "velocity y at [10, 5] m",
        "traction n at [10, 10] m",
        "traction s at [10, 10] m",
    ]
    headings = [panel.place.heading for panel in level]
    assert headings == ["velocity y at [10, 5] m", "traction n at [10, 10] m"]


def test_all_pictures_are_made(solved):
    found = solved(30.0)
    figures = figures_of("mass", found, [{}])
    assert [one.name for one in figures] == ["mass-scene", "mass-waveforms", "mass-spectra"]
    waveforms, spectra = figures[1].table, figures[2].table
    assert "oblique-joint | traction s at [10, 10] m (Pa)" in waveforms
    assert "Dotted: 1/T of the load 200 Hz" in figures[2].caption and len(spectra) > 10
    table = curve_table(found)
    column = "oblique-joint | velocity y at [10, 5] m (m/s)"
    expected = found[0].results["oblique-joint"].velocity.values[0, :, 1]
    assert table[column].to_numpy() == pytest.approx(expected)


def test_tables_name_places(solved):
    """Two variants beside each other as two solutions would be: a row a place, x and y apart."""
    one, other = solved(30.0, 0.0)
    results = {
        "continuum-jointed": other.results["oblique-joint"],
        "oblique-joint": one.results["oblique-joint"],
    }
    one.rows = measure(results)
    frame = distance_frame([one])
    assert {"x (m)", "y (m)"} <= set(frame) and set(frame["y (m)"]) == {5.0, 10.0}
    assert "velocity x" in set(frame.quantity) and "slip" in set(frame.quantity)
    table = misfit_table([one])
    assert {"base scene, velocity x at [10, 5] m", "base scene, traction n at [10, 10] m"} < {
        *table.index
    }
    assert list(table) == [("numerical error", "continuum-jointed ~ oblique-joint (%)")]

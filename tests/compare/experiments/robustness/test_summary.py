"""The study's table, figure and sentences, of a few rows and coarse maps."""

import csv

import numpy as np
import pytest

from compare.experiments.robustness import summary
from compare.experiments.robustness.criteria.energies import Drift
from compare.experiments.robustness.map import make_map
from compare.experiments.robustness.run import CASES, FAILED, places, row_at


@pytest.fixture(scope="module")
def rows():
    """Return the rows of the first case, one of them made to fail."""
    found = [row_at(place) for place in places() if place[0] == 0]
    return [found[0]._replace(state=FAILED, message="because"), *found[1:]]


def test_table_has_every_row_with_its_margin_or_reason(rows):
    """Under a heading of case and criterion; a failed row says so."""
    found = summary.table(rows)
    lines = found.to_numpy().tolist()
    assert all(heading.startswith(CASES[0].name) for heading, _ in found.index)
    assert len(lines) == len(rows)
    assert lines[0][-1] == "failed: because" and f"{rows[1].margin:.3g}" in lines[1]
    assert any("does not apply" in line[-1] for line in lines)
    assert len(summary.failures(rows)) == 1 and "3 of 4 rows pass" in summary.sentences(rows, [])[0]


def test_files_hold_every_row_and_cell(rows, tmp_path):
    """CSV, one line each below the header."""
    found = make_map("dem", cells=5)
    files = summary.write(tmp_path, rows, [found])
    for path, count in zip(files, (len(rows), 25), strict=True):
        with path.open(newline="") as file:
            assert len(list(csv.DictReader(file))) == count


def test_figure_has_maps_line_and_energies():
    """Each map with its line and its count of wrong cells; each energy as its own curve."""
    found = make_map("dem", cells=5)
    energy = Drift(np.array([0.0, 1e6]), np.array([0.0, 1e-13]))
    figure = summary.draw([found], {"dem leapfrog": energy})
    gids = {artist.get_gid() for artist in figure.findobj()} - {None}
    assert gids == {"stability-map-0", "stability-line-0", "stability-energy-0"}


def test_the_map_covers_its_stable_cells():
    """In cells of unit size the drawn area is their number."""
    stable = np.array([[True, False, True], [False, False, False], [True, True, True]])
    drawn = summary.stretches(stable, np.arange(4.0), np.arange(4.0))
    corners = sorted(tuple(map(int, (*one.min(axis=0), *one.max(axis=0)))) for one in drawn)
    assert corners == [(0, 0, 1, 1), (0, 2, 3, 3), (2, 0, 3, 1)]

"""The study of hard cases: every row holds or says why it does not apply; its table and map."""

from math import nan

import numpy as np
import pytest

from hard_runs import CROSSED
from jointwave.compare.engines import ENGINES, solve
from jointwave.compare.studies import hard_cases, hard_map
from jointwave.compare.studies.hard_cases import NONE, STABLE, judged, title_of
from jointwave.compare.studies.hard_map import boundary, cells_of, columns, computed

CASES = hard_cases.hard_cases()
#: Laws whose kernels take long to compile.
LAWS = ("slip weakens", "stiffen", "dilate", "rate of slip", "rock of Q")


def rows():
    for case in CASES:
        slow = any(word in case["variant"] for word in LAWS)
        slow |= (case["engine"], case["scheme"]) in CROSSED
        name = f"{title_of(case)}, {case['engine']} {case['scheme']}"
        yield pytest.param(case, id=name, marks=[pytest.mark.slow] if slow else [])


@pytest.mark.parametrize("case", list(rows()))
def test_row_holds_or_says_why_not(case):
    (row,) = judged([hard_cases.run(case)]).itertuples()
    assert row.holds, row
    assert row.ended == case["should"] or (row.ended == NONE and len(row.message) > 10)


def test_row_that_is_out_of_bounds_does_not_hold():
    """Nor one that ends otherwise than it should, or whose value is nan."""
    point = dict(zip(hard_cases.POINT, ("hard/a", "", "dem", "leapfrog", STABLE), strict=True))
    row = point | {"ended": STABLE, "misfit": 1e-3, "misfit_bound": 2e-3}
    others = ({"misfit": 3e-3}, {"misfit": nan}, {"ended": "stopped"}, {"ended": NONE})
    found = judged([row, *(row | other for other in others)])
    assert found.holds.tolist() == [True, False, False, False, True] and found.margin[0] == 2


def test_dissipated_energy_that_comes_back_is_seen(pillar):
    """A viscous term that falls by a millionth of the work breaks the second law."""
    result = solve("dem", pillar(joints__damping_ratio=0.1))
    assert hard_cases.largest_fall(result) < 1e-12
    work = float(np.abs(result.energy.sel(term="work")).max())
    viscous = result.energy.values[list(result.term.values).index("viscous")]
    viscous[-1] = viscous[:-1].max() - 1e-6 * work
    assert hard_cases.largest_fall(result) == pytest.approx(1e-6, rel=0.1)


def test_no_cell_is_wrong_beyond_one_of_the_line():
    """Both stable and unstable cells are many, and all but those on the line are as theory says;
    the opposite ones are not."""
    found = [computed(one) for one in columns(cells=8)]
    opposite = [one | {"stable": [not x for x in one["stable"]]} for one in found]
    cells, others = cells_of(found), cells_of(opposite)
    assert cells.engine.unique().tolist() == list(ENGINES)
    for engine, own in cells.groupby("engine"):
        assert 0.2 < own.stable.mean() < 0.8
        assert not own.far.any()
        assert others[others.engine == engine].far.sum() > 20


def test_line_is_the_critical_step_of_one_mode():
    """x = omega dt / 2 of dt = sqrt(4 eta^2 + 4 / omega^2) - 2 eta, zeta = eta omega / 2."""
    ratio = np.array([0.0, 0.01, 1.0, 10.0])
    expected = np.sqrt(4 * ratio**2 + 1) - 2 * ratio
    assert boundary(ratio) == pytest.approx(expected, rel=1e-13)


def test_files_table_and_sentences_tell_of_every_row(tmp_path, monkeypatch):
    """Of the short pillar alone and coarse maps; a row that fails says so."""
    few = [case for case in CASES if title_of(case) == "short-pillar"]
    monkeypatch.setattr(hard_cases, "hard_cases", lambda: few)
    columns = hard_map.columns(("dem",), 5)
    monkeypatch.setattr(hard_map, "columns", lambda: columns)
    found = hard_cases.experiment(tmp_path).make()
    assert (tmp_path / "stability.csv").read_text().count("\n") == len(few) + 1
    assert (tmp_path / "stability-map.csv").read_text().count("\n") == 25 + 1
    svg = (tmp_path / "stability.svg").read_text()
    assert all(f"stability-{part}-0" in svg for part in ("map", "line"))
    assert f"{len(few)} of {len(few)} rows hold" in found.sentences[0] and not found.failed
    assert len(found.table.loc["short-pillar"]) == len(found.table) == len(few)
    row = hard_cases.run(few[0]) | {"ended": "stopped", "message": "why"}
    wrong = hard_cases.table(judged([row]))
    assert wrong.iloc[0, -1] == "failed: why"

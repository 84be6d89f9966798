"""Work-precision diagrams show every point, and sentences say their numbers."""

import numpy as np

from compare.studies.diagram import draw, look
from compare.studies.findings import sentences
from compare.studies.pareto import measured
from compare.studies.runner import run


def test_every_point_is_drawn_where_it_was_measured(study, tmp_path):
    """Two errors over two costs; each curve's line holds its points in the study's order."""
    timed = study(timed=True, repeats=1, finest="jointed-bar")
    rows = run(timed, tmp_path)
    figure = draw("wp", timed, rows)
    lines = {line.get_gid(): line for ax in figure.axes for line in ax.lines}
    for i, error in enumerate(("numerical", "total")):
        for j, cost in enumerate(("seconds", "work")):
            line = lines[f"wp-{i}-{j}-0"]
            assert list(line.get_xdata()) == [getattr(row, cost) for row in rows]
            assert list(line.get_ydata()) == [getattr(row, error) for row in rows]
    assert all(ax.get_xscale() == ax.get_yscale() == "log" for ax in figure.axes)


def test_sentences_hold_for_their_numbers(study, tmp_path):
    timed = study(timed=True, repeats=1, finest="lattice")
    rows = [
        row._replace(total=error, seconds=cost, curve=name)
        for row, error, cost, name in zip(
            run(timed, tmp_path), (0.05, 0.02, 0.005, 0.004), (1, 2, 4, 12.0), "abab", strict=True
        )
    ]
    one, two, most = sentences(timed, rows)
    assert most == "The most digits a second, 1.3, are those of a at 5.00 %."
    assert "Within 10.0 %" in one and "a (5.00 %)" in one and "b, takes 2 times" in one
    assert "Within 1.00 %" in two and "a (0.500 %)" in two and "b, takes 3 times" in two
    assert sentences(study(), rows) == []


def test_points_without_a_number_are_not_drawn(study, tmp_path):
    rows = run(study(), tmp_path)
    assert measured(rows, "total", "work") == []
    assert np.isfinite([row.numerical for row in measured(rows, "numerical", "work")]).all()


def test_dotted_lines_join_equal_digits_a_second(study, tmp_path):
    """Over seconds alone, each a power of ten of -log10(error) / seconds."""
    timed = study(timed=True, repeats=1)
    figure = draw("wp", timed, run(timed, tmp_path))
    seconds, work = figure.axes
    dotted = [line for line in seconds.lines if line.get_linestyle() == ":"]
    assert dotted and not [line for line in work.lines if line.get_linestyle() == ":"]
    for line in dotted:
        rate = np.log10(-np.log10(line.get_ydata()) / line.get_xdata())
        assert np.allclose(rate, np.round(rate[0]), atol=1e-9)


def test_an_order_of_elements_has_one_marker_and_what_is_implicit_is_dashed(study):
    scheme, order = "numerics.continuum.scheme", "numerics.continuum.order"
    curves = [
        {"label": f"{m} {s} {p}", "method": m, "changes": {scheme: s, order: p}}
        for m in ("continuum-jointed", "continuum-equivalent")
        for s in ("explicit", "implicit")
        for p in (1, 4)
    ]
    looks = [look(study(curves), k) for k in range(len(curves))]
    assert len({(x["color"], x["marker"], str(x["linestyle"])) for x in looks}) == len(curves)
    assert len({x["color"] for x in looks}) == 2 == len({x["marker"] for x in looks})

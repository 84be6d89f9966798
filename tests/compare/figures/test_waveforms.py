"""Waveforms that share a pair of axes, and their residuals from the reference."""

from itertools import pairwise

import numpy as np
import pytest

from jointwave import cases
from jointwave.compare.engines import applies, label_of, solve
from jointwave.compare.figures.charts import waveforms as charts
from jointwave.compare.figures.charts.waveforms import MOST, REFERENCE, by_variant, draw_solutions
from jointwave.compare.figures.receivers import panels, variant_names
from jointwave.compare.figures.style import GIVEN
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.places import Place
from jointwave.compare.misfit.ranking import finest
from jointwave.compare.scenes import find

SHORT = {"time__duration": 0.03}
DAMPED = {"joints__damping_ratio": 0.1}
DAMPINGS = ["undamped", "ζ = 0.02", "ζ = 0.05", "ζ = 0.1"]


@pytest.fixture
def solved(pillar):
    """Return a function that solves short pillars with these changes exactly, variants a, b, ...,
    with the bars and the chain in place of the engines."""
    engines = ("dem", "continuum-jointed", "continuum-equivalent")

    def solve_all(*changes, by=("lattice", "jointed-bar", "equivalent-bar")):
        found = []
        for letter, change in zip("ab", changes, strict=False):
            scene = pillar(**SHORT | change).model_copy(update={"name": letter})
            results = {name: solve(name, scene) for name in by if applies(name, scene)}
            as_engines = {e: results[n] for n, e in zip(by, engines, strict=False) if n in results}
            found.append(Comparison(scene, results | as_engines))
        return found

    return solve_all


@pytest.mark.parametrize(
    ("name", "key", "words"),
    [
        ("guo-li-2002/fig-03", "joints.damping_ratio", DAMPINGS),
        ("guo-li-2002/fig-05", "ends.end", ["free", "quiet", "matched"]),
        ("guo-li-2002/fig-07", "soft_layers", ["no soft layer", "soft layer"]),
        ("guo-li-2002/fig-09", "joints.tension", ["tension", "no tension"]),
        ("beyond/cantilever-gravity", None, None),  # several
        ("guo-li-2002/fig-04", None, ["base scene"]),  # no variants
    ],
)
def test_variants_are_named_by_the_key_that_makes_them(name, key, words):
    found = [Comparison(scene) for scene in cases.load(find(name))]
    assert charts.changed_key(found) == key
    assert words is None or variant_names(found) == words


def test_variants_of_one_key_share_a_pair_of_axes_an_engine(solved, collisions):
    found = solved({}, DAMPED)
    ((dem, jointed, bar),) = by_variant(found)
    for overlay, engine in ((dem, "dem"), (jointed, "continuum-jointed")):
        waves = [t for t in overlay.traces if t.label != REFERENCE]
        assert [t.label for t in waves] == ["a", "b"] and label_of(engine) in overlay.heading
        for trace, comparison in zip(waves, found, strict=True):
            np.testing.assert_array_equal(trace.curve, comparison.results[engine].stress.values[0])
    assert all(t.residual.abs().max() == 0 for t in jointed.traces if t.label != REFERENCE)
    assert bar.traces[0].residual.any() and bar.reference == "jointed bar, exact"
    assert collisions(charts.draw_overlays(by_variant(found))) == []  # nor do headings meet


def test_variants_that_differ_twice_or_record_something_else_do_not(solved, pillar):
    assert by_variant(solved({}, {"ends__end": "quiet"} | DAMPED)) == []
    assert by_variant(solved({}, {})) == []
    across = {"load__direction": [1.0, 0.0, 0.0]}
    assert by_variant(solved({}, across, by=("lattice", "spatial-lattice"))) == []
    several = [pillar(joints__damping_ratio=0.01 * k) for k in range(MOST + 1)]
    assert by_variant([Comparison(scene) for scene in several]) == []


def test_a_residual_is_a_solution_less_the_reference_on_a_scale_of_its_own(solved):
    """So that a tenth of it is seen: the residuals fill their axes, and their size is said."""
    (found,) = solved({})
    panel = panels([found])[0][0]
    assert panel.reference == finest(found.results, found.scene).name == "jointed-bar"
    known = found.results["jointed-bar"].stress.values[0]
    sizes = []
    for name, residual in panel.residuals.items():
        expected = found.results[name].stress.values[0] - known
        np.testing.assert_array_equal(residual, expected)
        sizes.append(np.abs(expected).max())
    assert set(panel.curves) - set(panel.residuals) == {"jointed-bar"}
    share = 100 * max(sizes) / np.abs(known).max()
    upper, lower = draw_solutions([found]).axes[:2]
    for name, curve in panel.curves.items():
        drawn = next(x.get_ydata() for x in upper.lines if x.get_label() == label_of(name))
        np.testing.assert_allclose(1e6 * drawn, curve)
    low, high = lower.get_ylim()
    reach = max(np.abs(line.get_ydata()).max() for line in lower.lines)
    assert reach > 0.35 * (high - low)
    heading = lower.get_title(loc="left")
    assert 1 < share < 50 and f"≤ {share:.2g}\u00a0% of the peak" in heading


@pytest.mark.parametrize("count", range(2, MOST + 1))
def test_every_variant_is_seen_where_all_coincide(count):
    styles = sorted(charts.variant_styles(count), key=lambda style: style.order)
    assert all(a.width > b.width + 0.3 for a, b in pairwise(styles))


def test_curves_of_others_stand_beside_at_their_own_times(solved):
    (found,) = solved({}, by=("lattice",))
    alone = Comparison(found.scene, {"lattice": found.results["lattice"]})
    assert len(draw_solutions([alone]).axes) == 1  # of what has no residual
    time = np.array([0.0, 0.011, 0.017, 0.029])
    values = {Place("stress", "", (20.0,)): np.array([0.0, 1e5, 8e5, -2e5])}
    curves = Curves("lab.csv", "lab.csv", time, values)
    found.besides.append(align_curve(curves, found.scene, found.results, False))
    (picture,) = charts.waveforms("fig", [found])
    (line,) = (x for x in picture.figure.axes[0].lines if x.get_label() == "lab.csv")
    np.testing.assert_allclose(line.get_xdata(), 1e3 * time)
    np.testing.assert_allclose(line.get_ydata(), [0.0, 0.1, 0.8, -0.2])
    assert line.get_color() == GIVEN[0].colour

"""Waveforms that share a pair of axes, and their residuals from the reference."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.text import Text

from jointwave import cases
from jointwave.compare.engines import applies, label_of, solve
from jointwave.compare.figures.charts.waveforms import (
    MOST,
    REFERENCE,
    by_variant,
    changed_key,
    draw_overlays,
    draw_solutions,
    variant_styles,
)
from jointwave.compare.figures.receivers import panels
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.ranking import finest

SHIPPED = Path(cases.__file__).parent
SHORT = {"time__duration": 0.03}
#: A soft layer, a damping ratio and an end: every exact solution that is used here has them.
CHANGES = {
    "joints.damping_ratio": {"joints__damping_ratio": 0.1},
    "ends.end": {"ends__end": "quiet"},
    "soft_layers": {"soft_layers": [{"y": 20.0, "spacing_stiffness": 4.375e8}]},
}


def solved(*scenes, by=("lattice", "jointed-bar", "equivalent-bar")):
    """Return scenes solved exactly, with the bars and the chain in place of the engines."""
    engines = dict(zip(by, ("dem", "continuum-jointed", "continuum-equivalent"), strict=False))
    found = []
    for scene in scenes:
        results = {name: solve(name, scene) for name in by if applies(name, scene)}
        results |= {engines[name]: result for name, result in list(results.items())}
        found.append(Comparison(scene, results))
    return found


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("guo-li-2002/fig-03", "joints.damping_ratio"),
        ("guo-li-2002/fig-05", "ends.end"),
        ("guo-li-2002/fig-06", "joints.damping_ratio"),  # and how it is stepped
        ("guo-li-2002/fig-07", "soft_layers"),
        ("guo-li-2002/fig-08", "soft_layers"),
        ("guo-li-2002/fig-09", "joints.tension"),
        ("guo-li-2002/fig-10", "joints.tension"),
        ("beyond/prestressed-no-tension", "prestress.normal"),
        ("beyond/shear-pulse", "motion.rotation"),
        ("beyond/cantilever-gravity", None),  # several
        ("guo-li-2002/fig-04", None),  # no variants
    ],
)
def test_the_key_that_makes_the_variants_of_a_scene(name, key):
    scenes = cases.load(SHIPPED / f"{name}.toml")
    assert changed_key([Comparison(scene) for scene in scenes]) == key


@pytest.mark.parametrize("key", CHANGES)
def test_variants_of_one_key_share_a_pair_of_axes_an_engine(pillar, key):
    scenes = [pillar(**SHORT), pillar(**SHORT, **CHANGES[key])]
    found = solved(*(s.model_copy(update={"name": n}) for s, n in zip(scenes, "ab", strict=True)))
    assert changed_key(found) == key
    ((dem, jointed, bar),) = by_variant(found)
    for overlay, engine in ((dem, "dem"), (jointed, "continuum-jointed")):
        waves = [t for t in overlay.traces if t.label != REFERENCE]
        assert [t.label for t in waves] == ["a", "b"] and label_of(engine) in overlay.heading
        for trace, comparison in zip(waves, found, strict=True):
            np.testing.assert_array_equal(trace.curve, comparison.results[engine].stress.values[0])
    assert all(t.residual.abs().max() == 0 for t in jointed.traces if t.label != REFERENCE)
    assert bar.traces[0].residual.any() and bar.reference == "jointed bar, exact"


def test_variants_that_differ_twice_or_record_something_else_do_not(pillar):
    twice = pillar(**SHORT, ends__end="quiet", joints__damping_ratio=0.1)
    assert by_variant(solved(pillar(**SHORT), twice)) == []
    assert by_variant(solved(pillar(**SHORT), pillar(**SHORT))) == []
    across = pillar(**SHORT, load__direction=[1.0, 0.0, 0.0])
    by = ("spatial-lattice",)
    assert by_variant(solved(pillar(**SHORT), across, by=("lattice", *by))) == []
    several = [pillar(**SHORT, joints__damping_ratio=0.01 * k) for k in range(MOST + 1)]
    assert by_variant([Comparison(scene) for scene in several]) == []


def test_a_residual_is_a_solution_less_the_reference_on_a_scale_of_its_own(pillar):
    """So that a tenth of it is seen: the residuals fill their axes, and their size is said."""
    (found,) = solved(pillar(**SHORT))
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
    lower = draw_solutions([found]).axes[1]
    low, high = lower.get_ylim()
    reach = max(np.abs(line.get_ydata()).max() for line in lower.lines)
    assert reach > 0.35 * (high - low)
    heading = lower.get_title(loc="left")
    assert 1 < share < 50 and f"≤ {share:.2g}\u00a0% of the peak" in heading


def test_a_lone_solution_has_no_residual(pillar):
    (found,) = solved(pillar(**SHORT), by=("lattice",))
    found.results.pop("dem")
    assert len(draw_solutions([found]).axes) == 1


@pytest.mark.parametrize("count", range(2, MOST + 1))
def test_every_variant_is_seen_where_all_coincide(count):
    styles = variant_styles(count)
    assert len({style.colour for style in styles}) == count
    widths = [style.width for style in sorted(styles, key=lambda style: style.order)]
    assert all(a > b + 0.3 for a, b in pairwise(widths))


def test_headings_of_a_figure_do_not_meet(pillar):
    """Above panels and residuals, three engines beside each other."""
    found = solved(pillar(**SHORT), pillar(**SHORT, joints__damping_ratio=0.1))
    figure = draw_overlays(by_variant(found))
    figure.canvas.draw()
    titles = {ax.get_title(loc="left") for ax in figure.axes}
    boxes = [t.get_window_extent() for t in figure.findobj(Text) if t.get_text() in titles - {""}]
    assert len(boxes) == 6
    assert not [
        (i, j) for i, a in enumerate(boxes) for j, b in enumerate(boxes) if i < j and a.overlaps(b)
    ]

"""Which components decide a misfit, on fields whose shares of the motion are known numbers."""

from itertools import product
from math import inf, nan

import numpy as np
import pytest
import xarray as xr

from jointwave.compare.misfit.differences import distance_of, peak_differences, static_difference
from jointwave.compare.misfit.metrics import pairings, worst
from jointwave.compare.misfit.places import Place
from jointwave.compare.misfit.weight import weigh

TIME = 1e-4 * np.arange(200)
WAVE = np.sin(2e3 * TIME)
ROOT = float(np.sqrt((WAVE**2).mean()))


def points(velocity=None, stress=None, **attrs):
    """Return a result of a rock mass with components [receiver, component], each times one wave."""
    given = [("velocity", "axis", ["x", "y"], velocity)]
    given += [("stress", "stress_component", ["xx", "yy", "xy"], stress)]
    data, coords = {}, {"time": TIME}
    for name, dim, components, factors in given:
        if factors is not None:
            data[name] = ("point", "time", dim), np.multiply.outer(factors, WAVE).swapaxes(1, 2)
            x = np.arange(float(len(factors)))
            coords |= {dim: components, "point_x": ("point", x), "point_y": ("point", 0 * x)}
    return xr.Dataset(data, coords, {"kind": "rock mass", **attrs})


def pair(one, other):
    return points(velocity=one), points(velocity=other)


@pytest.mark.parametrize(("share", "found"), [(0.049, 0.01), (0.051, 0.4)])
def test_a_component_decides_from_five_percent_of_the_motion_on(share, found):
    """The small component is 40 % off, the large one 1 %: at 4.9 % of the motion 1 % counts."""
    x, y = share, np.sqrt(1 - share**2)
    both = pair([[1.4 * x, 1.01 * y]], [[x, y]])
    far = worst(*both)
    assert far.misfit == pytest.approx(found) and not far.of_all
    assert far.place.component == ("x" if found == 0.4 else "y")
    rows = {p.place.component: p for p in pairings(*both)}
    assert rows["x"].misfit == pytest.approx(0.4) and rows["x"].faint == (share < 0.05)


def test_motion_that_the_reference_does_not_have_counts_as_a_part_of_all_motion():
    """Symmetry forbids the motion across: a spurious tenth of the motion is 10 %, not infinite; 4 %
    decide nothing and stand nowhere."""
    far = worst(*pair([[0.1, 1.0]], [[0.0, 1.0]]))
    assert far.misfit == pytest.approx(0.1) and far.where.endswith("of all motion there")
    quiet = pair([[0.04, 1.0]], [[1e-9, 1.0]])
    assert worst(*quiet).misfit == 0
    assert [p.place.component for p in pairings(*quiet)] == ["y"]


@pytest.mark.parametrize(("excited", "listed"), [(0.9e-6, ["y"]), (1.1e-6, ["x", "y"])])
def test_what_the_scene_does_not_excite_stands_nowhere(excited, listed):
    """A million times the motion of a component that is round-off is listed from 1e-6 on."""
    found = pairings(*pair([[1e-3, 1.0]], [[excited, 1.0]]))
    assert [p.place.component for p in found] == listed


def test_a_receiver_without_motion_decides_nothing():
    """At a free end stress itself is zero: half a percent of the largest stays out, two are 2 %."""
    for unit, (spurious, misfit) in product((1e-12, 1.0, 1e12), ((0.005, 0.0), (0.02, 0.02))):
        one, other = ([[0.0, unit], [0.0, unit * small]] for small in (spurious, 0.0))
        assert worst(*pair(one, other)).misfit == pytest.approx(misfit)


def test_the_motion_of_a_tensor_does_not_depend_on_the_axes():
    """Uniaxial stress, turned by any angle, has one norm; its shear counts twice in it."""
    for angle in np.radians([0, 20, 45]):
        c, s = np.cos(angle), np.sin(angle)
        names = [Place("stress", name, (1.0, 2.0)) for name in ("xx", "yy", "xy")]
        moved = np.abs([c * c, s * s, c * s])
        found = weigh([*names, Place("velocity", "y", (1.0, 2.0))], np.array([*moved, 1.0]))
        small = moved < 0.05
        np.testing.assert_allclose(found.norm[:3][small], 1.0)
        np.testing.assert_allclose(found.norm[:3][~small], moved[~small])


def test_peaks_are_those_of_all_components_together():
    """A velocity of 3 and 4 has a peak of 5; a stress of 2, 1 and xy 1.2 one of 2.8. Mean and worst
    are over the receivers; one whose peak is below 1 % of the largest does not count."""
    other = points([[3, 4], [0, 1], [0, 1e-3]], [[2, 1, 1.2], [0, 1, 0], [0, 1e-3, 0]])
    one = points([[3, 4], [0, 1.3], [0, 2e-3]], [[2, 1, 1.2], [0, 0.9, 0], [0, 1e-3, 0]])
    found = peak_differences(one, other)
    assert found["PPV"].mean == pytest.approx(0.15) and found["PPV"].worst == pytest.approx(0.3)
    assert found["PPV"].at == (1.0, 0.0)
    assert found["peak stress"][:2] == pytest.approx((0.05, 0.1))
    turned = points([[5, 0]], [[2.8, 0, 0]]), points([[3, 4]], [[2, 1, 1.2]])
    assert [one.worst for one in peak_differences(*turned).values()] == pytest.approx([0, 0])


@pytest.mark.parametrize(
    ("of", "distance", "where"),
    [
        ("", 0.5, "stress yy at [0, 0] m"),
        ("stress", 0.5, "stress yy at [0, 0] m"),
        ("velocity", 0.2, "velocity x at [1, 0] m"),
        ("PPV", 0.1, "PPV at [0, 0] m"),
        ("peak stress", 0.25, "peak stress at [0, 0] m"),
        ("traction", nan, "nothing moves"),
    ],
)
def test_a_bound_is_of_the_worst_waveform_of_a_quantity_or_a_peak(of, distance, where):
    other = points([[0, 1], [0.6, 0.8]], [[2, 1, 0], [0, 1, 0]])
    one = points([[0, 1.1], [0.72, 0.8]], [[2, 1.5, 0], [0, 1, 0]])
    one["stress"][0, :, 0] *= 1.25
    found = distance_of(of, one, other)
    assert found.misfit == pytest.approx(distance, nan_ok=True) and found.where == where


def test_a_peak_that_the_reference_does_not_have_is_within_no_bound():
    moving, still = points(velocity=[[0, 1]]), points(velocity=[[0, 0]])
    assert distance_of("PPV", moving, still).misfit == inf
    assert distance_of("PPV", still, moving).misfit == 1
    assert distance_of("PPV", still, still).misfit == 0


def test_a_peak_is_known_no_better_than_its_reference():
    """Ten times the reference's own error, of the waveforms that the peak is of."""
    other = points(velocity=[[0, 1]])
    other["velocity_error"] = (("point", "axis"), [[0.0, 0.02 * ROOT]])
    found = distance_of("PPV", points(velocity=[[0, 1.1]]), other)
    assert (found.misfit, found.judged) == pytest.approx((0.1, 0.2))


def test_static_states_that_differ_are_named_apart_from_the_motion():
    """Both move alike from static states that differ by a tenth of the largest static stress."""
    still = {"starts": "prestressed"}
    other = points(stress=[[0, 1, 0]], **still)
    other["stress"] = other.stress + xr.DataArray([5.0, 10.0, 0.0], dims="stress_component")
    one = other.copy()
    one["stress"] = other.stress + xr.DataArray([1.0, 0.5, 0.0], dims="stress_component")
    found = static_difference(one, other)
    assert found.misfit == pytest.approx(0.1) and found.place.component == "xx"
    assert worst(one, other).misfit == pytest.approx(0, abs=1e-12)

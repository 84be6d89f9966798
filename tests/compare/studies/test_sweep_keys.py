"""Arguments of `--sweep`: values between two ends, or a list."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.cases.errors import SceneError
from jointwave.compare.studies.sweep_keys import axes

KEY = "joints.damping_ratio"


def values(spec):
    ((key, found),) = axes([f"{KEY}={spec}"], []).items()
    assert key == KEY
    return found


def test_values_between_two_ends():
    assert values("0:1:5") == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert values("0.1:0.7:7") == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]  # no round-off in names
    np.testing.assert_allclose(values("0.01:0.5:8"), np.linspace(0.01, 0.5, 8), rtol=1e-11)
    assert values("2:-2:3") == [2, 0, -2]


def test_a_constant_factor_between_two_ends():
    assert values("log:1e8:1e10:3") == [1e8, 1e9, 1e10]
    np.testing.assert_allclose(values("log:0.01:0.5:8"), np.geomspace(0.01, 0.5, 8), rtol=1e-11)
    np.testing.assert_allclose(values("log:-1:-4:3"), [-1, -2, -4])


def test_whole_numbers_stay_whole():
    """A key that takes no others is swept too."""
    found = values("1:4:4")
    assert found == [1, 2, 3, 4] and all(isinstance(value, int) for value in found)
    assert values("1:4:3") == [1, 2.5, 4]


@pytest.mark.parametrize(
    "spec, expected",
    [
        ("0,0.1,0.5", [0, 0.1, 0.5]),
        ("0.3", [0.3]),
        ("true,false", [True, False]),
        ("free,quiet", ["free", "quiet"]),
        ('"a,b","c:d"', ["a,b", "c:d"]),
        ("[0,1,0],[1,0,0]", [[0, 1, 0], [1, 0, 0]]),
        ("[],[{y=8.0,thickness=0.1}]", [[], [{"y": 8.0, "thickness": 0.1}]]),
    ],
)
def test_values_that_are_listed(spec, expected):
    found = values(spec)
    assert found == expected and list(map(type, found)) == list(map(type, expected))


@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6), st.integers(2, 50))
def test_the_ends_are_what_was_given(first, last, count):
    if first == last:
        return
    found = values(f"{first!r}:{last!r}:{count}")
    assert len(found) == count and (found[0], found[-1]) == (first, last)


@pytest.mark.parametrize(
    "spec, words",
    [
        ("", "must be KEY=FROM:TO:COUNT"),
        ("1:2", "must be KEY=FROM:TO:COUNT"),
        ("1:2:3:4", "must be KEY=FROM:TO:COUNT"),
        ("log:1:2", "of numbers"),
        ("a:b:3", "of numbers"),
        ("1:2:2.5", "of numbers"),
        ("1:2:1", "COUNT of 2"),
        ("1:2:-3", "COUNT of 2"),
        ("1:2:20000", "COUNT of 2"),
        ("1:1:3", "ends that differ"),
        ("nan:1:3", "finite ends"),
        ("1:inf:3", "finite ends"),
        ("log:0:1:3", "one sign"),
        ("log:-1:1:3", "one sign"),
        ("0.1,0.1", "repeat a value"),
        ("1,1.0,true,1", "repeat a value"),
    ],
)
def test_a_bad_form_is_one_line(spec, words):
    with pytest.raises(SceneError, match=words) as error:
        values(spec)
    assert str(error.value).startswith("--sweep: ") and "\n" not in str(error.value)


def test_a_key_is_given_once():
    for swept, fixed in ((["a=1,2", "a=3,4"], []), (["a=1,2"], ["a"])):
        with pytest.raises(SceneError, match="a is given already"):
            axes(swept, fixed)
    with pytest.raises(SceneError, match="KEY=FROM"):
        axes(["nothing"], [])


def test_several_keys_make_few_points():
    found = axes(["a=1,2", "b=x,y,z"], ["c"])
    assert found == {"a": [1, 2], "b": ["x", "y", "z"]}
    with pytest.raises(SceneError, match=r"20,000 points; at most 10,000"):
        axes(["a=1:2:100", "b=1:2:200"], [])

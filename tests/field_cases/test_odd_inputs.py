"""Valid scenes at the edge of what makes sense: commands say nothing of numpy's about them, since
the tests turn its warnings into errors."""

import pytest

from tests.field_cases.scenes import mass

BED = {"name": "bed", "dip": 0.0, "spacing": 2.0}
LOAD = {"kind": "pressure", "opening": 0, "between": [[2.0, 2.0], [4.0, 2.0]]}


@pytest.mark.parametrize("amplitude", [0.0, 1e6], ids=["no load", "a whole face"])
@pytest.mark.parametrize("interval", [1e-5, 2e-3], ids=["many samples", "two samples"])
def test_nothing_is_divided_by_nothing(amplitude, interval, jointwave, tmp_path, in_toml):
    hole = [[2, 2], [4, 2], [4, 4], [2, 4]]
    tables = mass(
        *(6.0, 6.0),
        domain={"size": [6.0, 6.0], "non_convex": "cut", "openings": [hole]},
        joint_sets=[BED | {"normal_stiffness": 2e10, "shear_stiffness": 1e10}],
        boundaries={},
        loads=[LOAD | {"shape": "sine", "amplitude": amplitude, "period": 1e-3}],
        time={"duration": 2e-3},
        record={"points": [[1.0, 1.0], [5.0, 3.0]], "joints": [[1.0, 2.0]], "interval": interval},
        numerics={"continuum": {"size": 2.0, "order": 1}},
    )
    (path := tmp_path / "odd.toml").write_text(in_toml(tables))
    for command in ("explain", "compare"):
        assert "RuntimeWarning" not in jointwave(command, path).err

"""What a run reports about itself."""

import numpy as np
import pytest

from jointwave.continuum import simulate


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_attributes_survive_netcdf(short, tmp_path, dim):
    result = simulate(short(), dim=dim)
    expected = {
        "engine": "continuum-jointed",
        "model": "jointed",
        "scheme": "explicit",
        "dim": dim,
        "cell": ["interval", "quadrilateral", "hexahedron"][dim - 1],
        "order": 2,
        "degrees_of_freedom": 4 * dim * 3**dim,
    }
    assert {key: result.attrs[key] for key in expected} == expected
    assert result.attrs["dt"] * result.attrs["steps"] == pytest.approx(4e-3)
    assert result.attrs["dt"] <= 0.2 * result.attrs["critical_dt"]
    assert all(isinstance(value, str | int | float) for value in result.attrs.values())
    result.to_netcdf(tmp_path / "result.nc")


def test_axial_motion_has_one_axis_and_motion_in_space_three(short):
    """Variables and shapes are those of every engine: places by samples by axes."""
    axial, plane = simulate(short(), "jointed"), simulate(short(), dim=2)
    samples = axial["time"].size
    assert axial["velocity"].shape == axial["displacement"].shape == (3, samples, 1)
    assert plane["velocity"].shape == plane["rotation"].shape == (3, samples, 3)
    assert axial["stress"].shape == plane["stress"].shape == (3, samples)
    assert plane["shear"].shape == (3, samples, 2) and "shear" not in axial
    assert not plane["velocity"].values[..., 2].any() and not plane["shear"].values[..., 1].any()


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_section_on_a_joint_reads_the_same_from_either_side(short, dim):
    """The recovered stress is continuous across a joint, by balance of its nodes; that is as close
    as the sections are, the millionth of a millimetre below."""
    near = 1e-6
    places = {"stress": [1.0 - near, 1.0, 1.0 + near]}
    blow = {} if dim == 1 else {"load__direction": [0.6, 0.8, 0.0], "load__at": [0.1, 0.0]}
    result = simulate(short(record=places, **blow), dim=dim)
    for quantity in ("stress",) if dim == 1 else ("stress", "shear"):
        waves = result[quantity].values
        assert waves[0] == pytest.approx(waves[1], abs=1e-5 * np.abs(waves).max())
        assert waves[2] == pytest.approx(waves[1], abs=1e-5 * np.abs(waves).max())

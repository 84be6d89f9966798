"""Valid scenes at the edge of what makes sense: commands say nothing of numpy's about them, since
the tests turn its warnings into errors."""

import pytest

ROCK = """
title = "odd"
domain = {{ size = [6.0, 6.0], non_convex = "cut", openings = [[[2, 2], [4, 2], [4, 4], [2, 4]]] }}
rock = {{ density = 2600.0, intact_modulus = 5.0e10 }}
time = {{ duration = 2.0e-3 }}
record = {{ points = [[1.0, 1.0], [5.0, 3.0]], joints = [[1.0, 2.0]], interval = {interval} }}
numerics = {{ continuum = {{ size = 2.0, order = 1 }} }}

[[joint_sets]]
name = "bed"
dip = 0.0
spacing = 2.0
normal_stiffness = 2.0e10
shear_stiffness = 1.0e10

[[loads]]
kind = "pressure"
opening = 0
between = [[2.0, 2.0], [4.0, 2.0]]
shape = "sine"
amplitude = {amplitude}
period = 1.0e-3
"""


@pytest.mark.parametrize("amplitude", [0.0, 1e6], ids=["no load", "a whole face"])
@pytest.mark.parametrize("interval", [1e-5, 2e-3], ids=["many samples", "two samples"])
def test_nothing_is_divided_by_nothing(amplitude, interval, jointwave, tmp_path):
    path = tmp_path / "odd.toml"
    path.write_text(ROCK.format(amplitude=amplitude, interval=interval))
    for command in ("explain", "compare"):
        assert "RuntimeWarning" not in jointwave(command, path).err

"""A key whose physics is not built is refused, never ignored."""

import pytest

from cases import SceneError

UNAVAILABLE = {
    "soft_layers[0].thickness": {"soft_layers": [{"y": 20.0, "thickness": 0.05}]},
    "numerics.continuum.scheme": {"numerics.continuum.scheme": "implicit"},
}


@pytest.mark.parametrize("key", UNAVAILABLE)
def test_key_is_not_available_yet(scene_with, key):
    with pytest.raises(SceneError) as error:
        scene_with(**UNAVAILABLE[key])
    assert error.value.key == key
    assert str(error.value).endswith("not available yet")

"""The first steps of shipped scenes that say nothing of the rock in the blocks, in jointed rock.

Whatever applies to a shipped scene as it stands is held by `tests/theory/shipped_scenes.py`. Slow,
for nearly each compiles kernels of its own: of the effects one by one, ledgers close in
`test_energy.py` and momentum is kept in `test_conservation.py`.
"""

import numpy as np
import pytest

from jointwave import cases
from jointwave.compare.scenes import SHIPPED
from jointwave.continuum import applies, simulate
from jointwave.results.dataset import energy_residual

pytestmark = pytest.mark.slow
SAMPLES = 30
INTACT = 8.64e10  # Pa


SCENES = [
    pytest.param(path, scene.name, id=f"{path.stem}-{scene.name or 'base'}")
    for path in sorted((SHIPPED / "beyond").glob("*.toml"))
    for scene in cases.load(path)
    if scene.rock.intact_modulus is None
]


def first_steps(path, name: str):
    """Return a scene's first samples, with linear elements, one in each block."""
    scene = cases.load_variant(path, name, {})
    changes = {
        "time.duration": SAMPLES * scene.interval,
        "record": {"interval": scene.interval, "velocity": [0.0, scene.pillar.length]},
        "rock.intact_modulus": INTACT,
        "numerics.continuum": {"elements_per_block": 1, "order": 1},
        "expect": {},
    }
    return cases.load_variant(path, name, changes)


@pytest.mark.parametrize(("path", "name"), SCENES)
def test_scene_runs_wherever_the_continuum_says_so(path, name):
    """Finite, of the shape that was asked for, and with an energy ledger that closes: to round-off
    where explicit steps of linear rock are taken; elsewhere to the corners of the law, or to what
    implicit steps take from short waves."""
    scene = first_steps(path, name)
    reason = applies(scene, "jointed")
    if reason:
        with pytest.raises(cases.SceneError, match=reason[:20]):
            simulate(scene, "jointed")
        return
    result = simulate(scene, "jointed")
    assert result["time"].size == SAMPLES + 1
    assert all(np.isfinite(values).all() for values in result.data_vars.values())
    assert result["velocity"].values.any()
    law = scene.joints, *scene.layers
    bends = any(joint.tension is False or joint.tensile_strength for joint in law)
    exact = result.attrs["scheme"] == "explicit" and not bends
    assert energy_residual(result) < (1e-9 if exact else 1e-3)

"""Place and time at which a pulse first opens one of the joints of deformable jointed rock.

Until then the rock is linear: the first failure is that of the stress at all joints of
`jointed_bar`, to the scene's interval between samples. Of the homogenised bar and of rigid blocks
see `spall`.
"""

import numpy as np

from closed_forms.spall import Spall
from jointwave.cases.loads import late_load
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.bars import bar_of
from jointwave.compare.exact.bar.laplace import bounded


def jointed_spall(scene: Scene) -> Spall | None:
    """Return the first failure of the scene's jointed rock, None where there is none."""
    p, times = calibrate(scene), sample_times(scene)
    if p.tensile_strength is None:
        raise ValueError("no joint has a tensile strength")
    load, period = late_load(scene, "jointed"), scene.load.time_scale
    (stress, _, _), _ = bounded(
        bar_of(scene, resolved=True), load, times, p.joint_y.tolist(), [], period
    )
    fails = stress <= -p.tensile_strength[:, None]
    if not fails.any():
        return None
    first = int(np.argmax(fails.any(axis=0)))
    joint = int(np.argmin(stress[:, first] / p.tensile_strength))
    return Spall(float(scene.pillar.length - p.joint_y[joint]), float(times[first]))

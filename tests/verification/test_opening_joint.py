"""A joint without tension that a wave opens, shuts and opens again."""

import numpy as np
import pytest

import continuum
from cases.loads import load_history
from compare.exact import opening_joint
from compare.metrics import relative_l2

Z = 2400.0 * 2000.0


def run(bar, **changes):
    scene = bar(
        soft_layers=[{"y": 20.0, "tension": False}],
        time__duration=0.06,
        record={"stress": [10.0, 30.0], "velocity": [19.9, 20.1], "interval": 1e-5, "energy": False},
        **changes,
    )
    return scene, continuum.simulate(scene, "equivalent", 1)


def test_ricker(bar):
    scene, result = run(bar, numerics__continuum__elements_per_block=4)
    times = result.time.values
    load = load_history(scene)
    fine = times
    exactT = opening_joint.transmitted(load, times - 30 / 2000.0) / 2
    print(relative_l2(result.stress.values[1], exactT))
    gapx = opening_joint.gap(load, times - 20 / 2000., Z)/2
    u = result.displacement.values
    print(u.shape, gapx.max())
    gap = u[1,:]-u[0,:]
    print(np.abs(gap-gapx).max()/gapx.max())
    import matplotlib; matplotlib.use('Agg')
    import matplotlib.pyplot as plt
    f,a=plt.subplots(2,1,figsize=(9,8))
    a[0].plot(times,result.stress.values[1]); a[0].plot(times,exactT,'--')
    a[1].plot(times,gap); a[1].plot(times,gapx,'--'); f.savefig('/tmp/oj.png')

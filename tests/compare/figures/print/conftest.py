"""Shared by the tests of print figures: comparisons of any size, without running an engine."""

import numpy as np
import pytest

from compare.engines import names
from compare.misfit.pairs import Comparison
from results.dataset import dataset

EVERY = names()


@pytest.fixture
def many(pillar):
    """Return a function that gives variants with receivers, each a wave from all solutions named.

    The results have the schema of all; the waves are sines that arrive later at each receiver.
    """

    def comparisons(receivers, variants=1, solutions=EVERY, name="a joint of variant {}", **keys):
        places = [4.0 * (i + 1) for i in range(receivers)]
        scene = pillar(**{"record__stress": places, "record__velocity": []} | keys)
        time = np.linspace(0, scene.time.duration, 101)
        phase = 4 * time / time[-1] - np.arange(len(scene.record.stress))[:, None] / 8
        wave = scene.load.amplitude * np.sin(2 * np.pi * np.clip(phase, 0, 1))
        velocity = np.zeros((len(scene.record.velocity), len(time)))
        names = ["", *(name.replace("{}", str(i)) for i in range(1, variants))]
        scenes = [scene.model_copy(update={"name": one}) for one in names]
        return [
            Comparison(one, {s: dataset(one, s, time, wave, velocity) for s in solutions})
            for one in scenes
        ]

    return comparisons

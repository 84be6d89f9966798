"""The error that a user meets crosses processes whole."""

import pickle

from jointwave.cases import SceneError


def test_scene_error_survives_a_worker_process():
    """Same type, message and parts after pickling, as a process pool does it."""
    error = SceneError("a.toml", "pillar.length", -1.0, "must be greater than 0")
    back = pickle.loads(pickle.dumps(error))
    assert type(back) is SceneError and str(back) == str(error)
    assert (back.where, back.key, back.value) == ("a.toml", "pillar.length", -1.0)

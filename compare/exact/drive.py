"""The excitation of a scene's start: its end stress, or the velocity of its base."""

from cases.histories import LoadHistory
from cases.loads import load_history, velocity_of
from cases.schema.scene import Scene


def drive(scene: Scene) -> LoadHistory:
    """Return the end stress (Pa) or, where the load is a motion, the base's velocity (m/s)."""
    load = scene.load
    if scene.shakes_base:
        return velocity_of(load, load.amplitude / load.scale)
    return load_history(scene)

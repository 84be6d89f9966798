"""Waveforms of all solutions at every receiver, over time."""

from compare.figures import draw
from compare.pairs import Comparison
from compare.panels import curve_table
from compare.pictures.picture import Picture


def waveforms(name: str, comparisons: list[Comparison]) -> Picture:
    """Return the waveforms of every variant at every receiver."""
    return Picture(
        f"{name}-waveforms",
        "waveforms",
        "Waveforms",
        "Every solution at every receiver.",
        draw(name, comparisons),
        curve_table(comparisons).reset_index(),
        None,
    )

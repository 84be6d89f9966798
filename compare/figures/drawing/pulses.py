"""Loads and waves over time and joint laws in words, drawn beside a scene."""

import numpy as np
from matplotlib.axes import Axes

from jointwave.cases.loads import history_of
from jointwave.cases.schema.joint import PARTS, JointLaw
from jointwave.cases.schema.pulse import Pulse
from jointwave.compare.figures.drawing.sketch import LOAD
from jointwave.compare.figures.units import unit_for

SAMPLES = 400
UNITS = {
    "stress": "Pa",
    "incident-stress": "Pa",
    "force": "N/m",
    "velocity": "m/s",
    "acceleration": "m/s²",
}


def draw_pulse(ax: Axes, pulse: Pulse, duration: float, words: str = "load") -> None:
    """Draw a load or wave over time, to a little after its end; words : its label."""
    time, values = pulse_curve(pulse, duration)
    unit = unit_for(UNITS[pulse.quantity], 1.001 * float(np.abs(values).max()))
    ax.axhline(0, color="#bbbbbb", linewidth=0.6)
    ax.plot(1e3 * time, values / unit.size, color=LOAD, linewidth=1.3)
    ax.set_xlabel("time (ms)", labelpad=1)
    ax.set_title(f"{words}, {pulse.shape} ({unit.name})", pad=4)
    ax.margins(x=0)


def pulse_curve(pulse: Pulse, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Return times (s) and the load or wave there, SI, from its start to a little after its end.

    duration : of the scene, s. An extreme load is scaled, see `cases.loads.load_history`.
    """
    scale = getattr(pulse, "scale", 1.0)
    history = history_of(pulse, pulse.amplitude / scale)
    end = min(duration, 1.25 * history.end or duration)
    time = np.linspace(0, end, SAMPLES)
    return time, scale * np.asarray(history.value(time))


def law_words(law: JointLaw) -> str:
    """Return the nonlinear properties of joints in words; empty for elastic joints."""
    parts = [
        f"damping ratio {law.damping_ratio:g}" if law.damping_ratio else "",
        "no tension" if law.tension is False else "",
        f"friction {law.friction_angle:g}°" if law.friction_angle is not None else "",
        *(part.drawn.format_map(vars(law)) for part in PARTS if part.of(law)),
    ]
    return ", ".join(part for part in parts if part)

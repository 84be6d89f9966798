"""Seismograms (SAC, miniSEED, SEG-2 and SEG-Y), read by ObsPy."""

import io
from collections.abc import Callable
from importlib.metadata import entry_points
from typing import Any
from warnings import catch_warnings, simplefilter

import numpy as np

#: ObsPy's names. Its own format detection would also unpickle a file.
FORMATS = ("SAC", "MSEED", "SEG2", "SEGY")
#: Start time of a trace on its own clock, s, for formats that have one.
BEGIN: dict[str, Callable[[Any], float]] = {
    "SAC": lambda stats: stats.sac.get("b") or 0.0,
    "SEG2": lambda stats: float(stats.seg2.get("DELAY", 0)),
    "SEGY": lambda stats: 1e-3 * stats.segy.trace_header.delay_recording_time,
}
SAC_ERROR = 0.01  # tolerated relative error of DELTA against B, E and NPTS of a SAC file


def format_of(content: bytes) -> str:
    """Return the format of a seismogram; "" for other content."""
    for form in FORMATS:
        (check,) = entry_points(group=f"obspy.plugin.waveform.{form}", name="isFormat")
        try:
            if check.load()(io.BytesIO(content)):
                return form
        except Exception:  # readers raise a dozen kinds
            continue
    return ""


def read_traces(content: bytes, form: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return the sample times of a seismogram [n], s, and the samples by channel [n].

    Times start at B of SAC, DELAY of SEG-2 or the delay of SEG-Y, else at zero. Raises ValueError,
    in one phrase, for gaps or a header that contradicts itself.
    """
    import obspy

    try:
        with catch_warnings():  # about SAC's rounded sampling intervals
            simplefilter("ignore")
            traces = list(obspy.read(io.BytesIO(content), format=form))
    except Exception:  # a damaged file raises any of a dozen kinds
        raise ValueError(f"cannot be read as {form}") from None
    named = {one.stats.channel or str(i): one for i, one in enumerate(traces, 1)}
    every = [(one.stats, BEGIN.get(form, lambda stats: 0.0)(one.stats)) for one in traces]
    shared = {(stats.delta, stats.npts, stats.starttime.ns, begin) for stats, begin in every}
    if len(shared) != 1 or len(named) < len(traces):
        allowed = "must hold each channel in one trace without gaps, all over the same times"
        raise ValueError(f"{allowed}; has {len(traces)} traces: {', '.join(named)[:200]}")
    stats, begin = every[0]
    step = _sac_step(stats.sac, stats) if form == "SAC" else float(stats.delta)
    if not step > 0:
        raise ValueError(f"must have a positive sampling interval, not {step:g} s")
    values = {name: np.asarray(one.data, dtype=float) for name, one in named.items()}
    return begin + step * np.arange(stats.npts), values


def _sac_step(header: Any, stats: Any) -> float:
    """Return the sampling interval of a SAC file, s, which ObsPy rounds to a microsecond."""
    if not header.get("leven", 1):
        raise ValueError("must be evenly sampled, LEVEN = 1")
    step, begin, end = float(header.delta), header.get("b"), header.get("e")
    meant = step if end is None else (end - (begin or 0.0)) / max(stats.npts - 1, 1)
    if stats.npts > 1 and abs(meant - step) > SAC_ERROR * abs(meant):
        given = "undefined (-12345)" if begin is None else f"{begin:g} s"
        rate = "; DELTA looks like the rate in Hz" if 0.99 < step * meant < 1.01 else ""
        raise ValueError(
            f"DELTA = {step:g} s contradicts B = {given}, E = {end:g} s and NPTS = {stats.npts}, "
            f"which give {meant:g} s{rate}"
        )
    return float(stats.delta) if abs(stats.delta - step) <= 1e-6 * step else step

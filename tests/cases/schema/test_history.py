"""Recorded histories as traces: files of ObsPy are read back; an error takes one line."""

import numpy as np
import obspy
import pytest

from cases.schema.history import History

SAMPLES = np.array([0.0, 3.0, -1.5, 0.25, 0.0])


def traces(*data, rate=500.0):
    """Return a stream of traces that begin one after the other."""
    start, found = obspy.UTCDateTime(2026, 1, 2), obspy.Stream()
    for i, samples in enumerate(data):
        header = {"sampling_rate": rate, "starttime": start + 10 * i}
        found.append(obspy.Trace(np.asarray(samples, dtype=np.float32), header))
    return found


@pytest.mark.parametrize(
    "form, name", [("SAC", "a.sac"), ("MSEED", "a.MSEED"), ("MSEED", "a.miniseed")]
)
def test_a_trace_is_its_samples_from_zero_on(tmp_path, form, name):
    traces(SAMPLES).write(str(tmp_path / name), format=form)
    found = History.read(tmp_path, name)
    assert found.time == pytest.approx(np.arange(5) / 500.0, rel=1e-6)
    assert found.stress.tolist() == SAMPLES.tolist()


def test_counts_are_numbers(tmp_path):
    stream = traces(SAMPLES)
    stream[0].data = np.array([0, 7, -9], dtype=np.int32)
    stream.write(str(tmp_path / "a.mseed"), format="MSEED")
    assert History.read(tmp_path, "a.mseed").stress.tolist() == [0.0, 7.0, -9.0]


@pytest.mark.parametrize(
    "name, data, words",
    [
        ("a.mseed", (SAMPLES, SAMPLES), "must contain one trace without gaps, has 2"),
        ("a.sac", ([1.0],), "must contain at least two samples"),
        ("a.sac", ([0.0, np.nan],), "must contain finite numbers"),
    ],
)
def test_what_is_no_history_is_said_in_one_line(tmp_path, name, data, words):
    traces(*data).write(str(tmp_path / name), format=name[2:].upper())
    with pytest.raises(ValueError, match=words):
        History.read(tmp_path, name)


@pytest.mark.parametrize("name, words", [("a.sac", "as SAC"), ("a.mseed", "as MSEED")])
@pytest.mark.parametrize("content", [b"", b"0,1\n1,2\n", bytes(700)])
def test_what_is_no_trace_is_refused(tmp_path, name, words, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ValueError, match=f"cannot be read {words}"):
        History.read(tmp_path, name)

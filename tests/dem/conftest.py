"""What the tests of rigid blocks share: the row in space as plain Python."""

import pytest

from dem.spatial import march


@pytest.fixture
def plain(monkeypatch):
    """Let rows in space take their steps as plain Python, on one thread: nothing is compiled."""
    kernel_for = march.march_for

    def python_for(form):
        kernel = kernel_for(form)
        return getattr(kernel, "py_func", kernel)

    monkeypatch.setattr(march, "march_for", python_for)
    monkeypatch.setattr(march, "borrowed", lambda value: value)
    monkeypatch.setattr(march, "flush_tiny", lambda: 0)
    monkeypatch.setattr(march, "restore_tiny", lambda old: None)
    monkeypatch.setattr(march, "peek", lambda counters, i: counters[i])
    monkeypatch.setattr(march, "post", lambda counters, i, value: counters.__setitem__(i, value))

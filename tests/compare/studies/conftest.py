"""The command as tests of experiments run it."""

import pytest


@pytest.fixture
def command(jointwave, tmp_path, monkeypatch):
    """Return a function that runs a command in this process and an empty folder, and gives what it
    said; `code` is what it must end with."""
    monkeypatch.chdir(tmp_path)
    return jointwave

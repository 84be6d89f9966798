"""What tests measure kept apart from the user's own; and a browser for the tests of pages."""

import shutil

import pytest

from compare import rates


@pytest.fixture(autouse=True)
def own_rates(tmp_path_factory, monkeypatch):
    """Keep what is measured here apart: `--dry-run` foretells from what the machine has done."""
    file = tmp_path_factory.mktemp("rates") / "rates.json"
    monkeypatch.setattr(rates, "_file", lambda: file)


@pytest.fixture(scope="session")
def browser():
    """Start a headless Chromium once; `make test` installs it on Debian."""
    path = shutil.which("chromium") or shutil.which("google-chrome")
    if path is None:
        pytest.skip("no chromium here: the page is not opened")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as player:
        started = player.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield started
        started.close()

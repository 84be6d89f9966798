"""The direction of imports, as the house is built: compare -> dem, continuum -> joints ->
numerics -> results -> cases."""

from importlinter.cli import EXIT_STATUS_SUCCESS, lint_imports


def test_imports_follow_the_arrows(monkeypatch):
    """Engines never import each other, exact solutions neither engine, nothing imports compare."""
    monkeypatch.chdir(__file__.rsplit("/tests/", 1)[0])
    assert lint_imports(no_cache=True) == EXIT_STATUS_SUCCESS

"""gmsh leaves the process as it found it."""

import locale
import signal
import sys

import pytest

from jointwave.continuum.mesh.session import gmsh_session


def test_interrupts_and_notation_stay(capfd):
    def handler(number, frame):
        raise AssertionError

    notation, before = locale.setlocale(locale.LC_NUMERIC), signal.signal(signal.SIGINT, handler)
    try:
        with gmsh_session() as gmsh:
            inside = signal.getsignal(signal.SIGINT)
            gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
            gmsh.model.occ.synchronize()
            gmsh.model.mesh.generate(2)
        assert inside is handler
        assert signal.getsignal(signal.SIGINT) is handler
        assert locale.setlocale(locale.LC_NUMERIC) == notation
    finally:
        signal.signal(signal.SIGINT, before)
    assert capfd.readouterr() == ("", "")


def test_an_open_session_is_refused_where_gmsh_can_tell():
    with gmsh_session() as gmsh:
        if not hasattr(gmsh, "isInitialized"):
            pytest.skip("gmsh before 4.9 cannot tell")
        with pytest.raises(RuntimeError, match="gmsh is in use"), gmsh_session():
            pass
        assert gmsh.model.getEntities() == []


def test_a_system_that_lacks_its_libraries_is_told_them(tmp_path, monkeypatch, jointwave):
    """The wheel raises OSError when the loader misses one: one line, with what to install."""
    reason = "libGLU.so.1: cannot open shared object file"
    (tmp_path / "gmsh.py").write_text(f"raise OSError({reason!r})")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "gmsh", raising=False)
    changes = ("numerics.continuum.dim=3", "numerics.continuum.cell=simplex")
    sets = [word for change in changes for word in ("--set", change)]
    scene = ("guo-li-2002/fig-03", "--variant", "", "--engine", "continuum", "--model", "jointed")
    said = jointwave("run", *scene, *sets, "--out", tmp_path, code=2).err.splitlines()[-1]
    assert f"numerics.continuum.cell = 'simplex': needs gmsh ({reason}; pip install gmsh" in said
    assert "libglu1-mesa" in said

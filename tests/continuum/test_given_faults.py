"""A gmsh file that does not fit the scene is refused in one line that says what is wrong; gmsh
leaves the process as it found it."""

import locale
import signal
import sys

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.continuum.mesh.session import gmsh_session
from jointwave.continuum.scene import body_of
from tests.continuum.drawing import DIMENSION, drawn


def test_missing_partners_are_counted_and_placed(tmp_path, column):
    """The last block's lower face is made narrower: facets of both sides lose their partners."""
    import meshio

    path = drawn(tmp_path / "pillar.msh", "quadrilateral", doubled=True)
    file = meshio.gmsh.read(path)
    cells = np.concatenate([block.data for block in file.cells if block.type == "quad"])
    of_last = cells[file.points[cells, 1].mean(axis=1) > 1.0]
    lower = np.intersect1d(of_last, np.flatnonzero(file.points[:, 1] < 1.0 + 1e-9))
    file.points[lower, 0] *= 0.5
    meshio.write(path, file, "gmsh22")
    with pytest.raises(SceneError) as error:
        body_of(column(path), dim=2)
    assert "4 facets of its joints have no coincident partner" in str(error.value)
    assert "the first at (-0.1, 1) m" in str(error.value)


QUADS, TRIANGLES = "quadrilateral", "triangle"
PIECES = {"doubled": True, "names": ["joint", "seam"]}
IN_SPACE, CUBIC = ({"changes": {f"numerics__continuum__{k}": 3}} for k in ("dim", "order"))
MISTAKES = {
    "too short": (QUADS, {"length": 1.4}, "spans y = 0 to 1.4 m, the pillar 0 to 1.5 m"),
    "too wide": (QUADS, {"side": 0.5}, "spans x = -0.25 to 0.25 m, the pillar -0.2 to"),
    "of second order": (QUADS, {"order": 2}, "has quad9 cells, must be first-order"),
    "of a wrong dimension": (QUADS, IN_SPACE, "quadrilateral cells.*dim = 3"),
    "pieces apart": (QUADS, PIECES, "4 facets coincide with others and are in no group 'joint"),
    "whole, 2.2": (QUADS, {"version": 2.2, "save_all": 1}, "save it with Mesh.SaveAll = 0"),
    "whole, 4.1": (QUADS, {"save_all": 1}, "cells in no group; save it with Mesh.SaveAll = 0"),
    "of third order": (TRIANGLES, CUBIC, "support numerics.continuum.order 1 or 2"),
}


@pytest.mark.parametrize(("kind", "options", "words"), MISTAKES.values(), ids=MISTAKES)
def test_what_does_not_fit_is_one_line(kind, options, words, tmp_path, column):
    own = {key: value for key, value in options.items() if key != "changes"}
    changes = {"numerics__continuum__dim": DIMENSION[kind]} | options.get("changes", {})
    scene = column(drawn(tmp_path / "pillar.msh", kind, **own), **changes)
    with pytest.raises(SceneError, match=words) as error:
        body_of(scene)
    assert "numerics.continuum.mesh = " in str(error.value)
    assert len(str(error.value).splitlines()) == 1


GOOD = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "rock"
1 2 "joint"
$EndPhysicalNames
$Nodes
6
1 -0.2 0 0
2 0.2 0 0
3 -0.2 0.5 0
4 0.2 0.5 0
5 -0.2 1.5 0
6 0.2 1.5 0
$EndNodes
$Elements
3
1 3 2 1 1 1 2 4 3
2 3 2 1 1 3 4 6 5
3 1 2 2 1 3 4
$EndElements
"""

UNREAD, AFTER = "cannot be read as a gmsh mesh", "2 3 2 1 1 3 4 6 5"
FILES = {
    "no mesh": (GOOD, "a,b\n1,2\n", UNREAD),
    "cut short": (GOOD[GOOD.index("4 0.2 0.5") :], "", UNREAD),
    "a number without end": ("6 0.2 1.5 0", "6000000000 0.2 1.5 0", f"{UNREAD}, version 2.2 or"),
    "no rock": ('"rock"', '"stone"', "no group whose name starts with 'rock'"),
    "a rock of lines": ('2 1 "rock"', '1 2 "rock"', "line cells"),
    "no cell in the rock": ('2 1 "rock"', '2 7 "rock"', "has no cells"),
    "two kinds": (AFTER, "2 2 2 1 1 3 4 6", "quad and triangle cells, must be of one kind"),
    "cells outside the rock": (AFTER, "2 3 2 0 1 3 4 6 5", "1 of its cells are in no group"),
    "a joint without facets": ('1 2 "joint"', '1 5 "joint"', "group 'joint' has no facets"),
    "a joint inside a cell": ("2 2 1 3 4", "2 2 1 3 6", "belong to no rock cell"),
    "a joint on the outside": ("2 2 1 3 4", "2 2 1 3 1", "(-0.2, 0.25) m"),
    "a cell inside out": ("1 1 2 4 3", "1 1 2 3 4", "1 of its cells are flat or inside out"),
    "a flat cell": ("3 -0.2 0.5 0", "3 0.2 0.5 0", "cells are flat or inside out"),
    "off the plane": ("3 -0.2 0.5 0", "3 -0.2 0.5 0.1", "spans z = 0 to 0.1 m"),
    "a start that is not": ('1 2 "joint"', '1 2 "start"', "start face must lie at y = 0 m"),
}


def read_text(text, tmp_path, column):
    path = tmp_path / "pillar.msh"
    path.write_text(text)
    return body_of(column(path), dim=2).body


@pytest.mark.parametrize(("old", "new", "words"), FILES.values(), ids=FILES)
def test_a_bad_file_is_one_line(old, new, words, tmp_path, column):
    text = GOOD.replace(old, new, 1) if old else new
    assert text != GOOD
    with pytest.raises(SceneError) as error:
        read_text(text, tmp_path, column)
    message = str(error.value)
    assert words in message
    assert len(message.splitlines()) == 1 and len(message) < len(str(tmp_path)) + 400


def test_a_good_file_is_read_without_a_word(tmp_path, column, capfd):
    """Cells that it repeats for another group count once."""
    again = "3 1 2 2 1 3 4\n4 3 2 9 1 3 4 6 5\n5 1 2 3 1 4 3\n"
    twice = GOOD.replace("3 1 2 2 1 3 4\n", again).replace("$Elements\n3", "$Elements\n5")
    twice = twice.replace("$PhysicalNames\n2", '$PhysicalNames\n4\n2 9 "top"\n1 3 "joint too"')
    for text in (GOOD, twice):
        body = read_text(text, tmp_path, column)
        assert (body.joints.column == 0).all() and len(body.x) == 2 * 9
    assert capfd.readouterr() == ("", "")


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

"""What a scene may not do: run code, leave its folder, replace a file that is not a result."""

import ast
import os
from pathlib import Path

import pytest

import cases
from cases.errors import SceneError
from cases.read import load, load_variant
from compare.jobs import plan
from compare.output import refuse_foreign, write_folder
from compare.studies.study import load as load_study

ROOT = Path(cases.__file__).parents[1]
PACKAGES = ("cases", "joints", "dem", "continuum", "compare")
SOURCES = [p for package in PACKAGES for p in sorted((ROOT / package).rglob("*.py"))]

#: Calls that make code of data, and modules that do.
CALLS = {"eval", "exec", "compile", "__import__"}
OWNED = {"os": {"system", "popen"}, "importlib": {"import_module"}, "builtins": CALLS}
MODULES = {"pickle", "cPickle", "dill", "cloudpickle", "marshal", "shelve", "yaml", "joblib"}

SCENE = """
title = "short"
pillar = { length = 2.0, side = 0.5, block = 0.5 }
rock = { density = 2400.0, p_speed = 2200.0, s_speed = 800.0 }
load = { LOAD }
time = { duration = 0.002 }
record = { stress = [1.0], velocity = [0.25] }
numerics = { NUMERICS }
"""
STEP = 'shape = "step", amplitude = 1.0'
#: Calls that read a file whole, and the modules that may: the doors, which ask its size before, and
#: those that read the program's own files or the system's.
READS = {
    "read_bytes",
    "load_dataset",
    "open_dataset",
    "read_csv",
    "genfromtxt",
    "loadtxt",
    "fromfile",
}
OF_PATHS = {"read_text"}
DOORS = {
    *("cases/files.py", "compare/netcdf.py"),  # the doors
    *("cases/size.py", "compare/studies/table.py"),  # of the system
    *("joints/cache.py", "compare/keeping/signature.py", "compare/starter.py"),  # of the program
    *("compare/page/render.py", "compare/page/section.py"),  # what has just been written or read
    "compare/peers.py",  # of a text in memory
    *("compare/pytest_plugin.py", "continuum/meshing/tagged.py"),  # once their size is known
}
HISTORY = "0,0\n1,1\n"


def faults_of(tree):
    """Yield what of a module makes code of data, or hands a text to a shell."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = {a.name.split(".")[0] for a in node.names}
            names |= {(getattr(node, "module", None) or "").split(".")[0]}
            yield from names & MODULES
        if isinstance(node, ast.Call):
            owner = getattr(getattr(node.func, "value", None), "id", None)
            if isinstance(node.func, ast.Name) and node.func.id in CALLS:
                yield node.func.id
            if owner in OWNED and node.func.attr in OWNED[owner]:
                yield node.func.attr
            given = {k.arg: getattr(k.value, "value", k.value) for k in node.keywords}
            if given.get("shell") or given.get("allow_pickle"):
                yield "shell or allow_pickle"


@pytest.mark.parametrize(
    "text, fault",
    [
        ("eval('1')", "eval"),
        ("import pickle", "pickle"),
        ("from yaml import load", "yaml"),
        ("subprocess.run('ls', shell=True)", "shell or allow_pickle"),
        ("np.load(f, allow_pickle=True)", "shell or allow_pickle"),
        ("os.system('ls')", "system"),
        ("re.compile('x')", None),
    ],
)
def test_the_search_finds_what_it_should(text, fault):
    assert next(faults_of(ast.parse(text)), None) == fault


def test_nothing_that_reads_or_runs_a_scene_makes_code_of_data():
    found = {
        str(path.relative_to(ROOT)): sorted(faults)
        for path in SOURCES
        if (faults := set(faults_of(ast.parse(path.read_text(encoding="utf-8")))))
    }
    assert found == {}


def reads_of(tree):
    """Yield the calls of a module that read a file whole, whatever its size."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            owner, name = getattr(node.func.value, "id", None), node.func.attr
            if name in READS or (name in OF_PATHS and owner != "files"):
                yield name
            if (owner, name) in {("np", "load"), ("json", "load"), ("pickle", "load")}:
                yield name


def test_files_are_read_through_the_doors_that_ask_their_size():
    found = {
        str(path.relative_to(ROOT))
        for path in SOURCES
        if any(reads_of(ast.parse(path.read_text(encoding="utf-8"))))
    }
    assert found <= DOORS


@pytest.fixture
def scene(tmp_path):
    """Return a function that writes a scene into a folder of its own and returns its path."""
    folder = tmp_path / "scene"
    (folder / "below").mkdir(parents=True)
    (tmp_path / "outside.csv").write_text(HISTORY)
    (tmp_path / "outside.msh").write_text("")
    (folder / "below" / "load.csv").write_text(HISTORY)
    (folder / "link.csv").symlink_to("below/load.csv")
    (folder / "away.csv").symlink_to("../outside.csv")
    (folder / "loop.csv").symlink_to("loop.csv")
    (folder / "out").symlink_to("..")
    os.mkfifo(folder / "pipe.csv")

    def write(file=None, mesh=None):
        where = f'shape = "table", amplitude = 1.0, file = {file!r}' if file is not None else STEP
        numerics = "" if mesh is None else f"continuum = {{ mesh = {mesh!r} }}"
        path = folder / "scene.toml"
        path.write_text(SCENE.replace("LOAD", where).replace("NUMERICS", numerics))
        return path

    return write


@pytest.mark.parametrize("file", ["below/load.csv", "./link.csv", "below/../link.csv"])
def test_a_load_below_the_scene_is_read(scene, file):
    assert len(load(scene(file))[0].load.history.time) == 2


AWAY = ["../outside.csv", "away.csv", "out/outside.csv", "/dev/zero", "/proc/self/environ", "/etc"]


@pytest.mark.parametrize("file", [*AWAY, "below/../../outside.csv"])
def test_a_load_outside_the_scenes_folder_is_refused(scene, file):
    with pytest.raises(SceneError, match=r"load\.file.* leaves the folder of the scene"):
        load(scene(file))


@pytest.mark.parametrize(
    "file, words",
    [
        ("pipe.csv", "not a regular file"),
        ("below", "is a directory"),
        ("loop.csv", "cannot be read"),
        ("x" * 5000, "cannot be read"),
        ("", "is a directory"),
    ],
)
def test_what_is_no_file_is_refused(scene, file, words):
    with pytest.raises(SceneError, match=f"load.file.*{words}"):
        load(scene(file))
    if words == "cannot be read":
        with pytest.raises(SceneError, match=r"numerics\.continuum\.mesh.*cannot be read"):
            load(scene(mesh=file))


def test_a_mesh_outside_the_scenes_folder_is_refused(scene, tmp_path):
    with pytest.raises(SceneError, match=r"numerics\.continuum\.mesh.* leaves the folder"):
        load(scene(mesh="../outside.msh"))
    asked = {"numerics.continuum.mesh": str(tmp_path / "outside.msh")}
    found = load_variant(scene(mesh="below.msh"), "", asked)
    assert found.numerics.continuum.mesh_path == tmp_path / "outside.msh"


def test_a_user_may_name_a_load_anywhere(scene, tmp_path):
    """By --set, of the key or of the whole table; not by some other key, nor may a study."""
    file, asked = str(tmp_path / "outside.csv"), "load.file"
    assert load(scene("gone.csv"), {asked: file})[0].load.history is not None
    table = {"shape": "table", "amplitude": 1.0, "file": file}
    assert load_variant(scene("gone.csv"), "", {"load": table}).load.history is not None
    with pytest.raises(SceneError, match="leaves the folder"):
        load(scene(file), {"load.amplitude": 2.0})
    with pytest.raises(SceneError, match="leaves the folder"):
        load_variant(scene("gone.csv"), "", {asked: file}, asked=False)


def test_a_study_does_not_leave_the_folder_of_its_scene(scene, tmp_path):
    place = tmp_path / "study.toml"
    curve = '[[curves]]\nlabel = "a"\nmethod = "dem"'
    changes = f'changes = {{ "load.file" = "{tmp_path}/outside.csv" }}'
    place.write_text(f'title = "s"\nscene = "{scene("gone.csv")}"\n{changes}\n{curve}\n')
    with pytest.raises(SceneError, match="leaves the folder"):
        load_study(str(place)).points()[0].scene  # noqa: B018


@pytest.mark.parametrize(
    "name", ["../x", "/x", "a/b", "..", ".x", " x", "a\\b", "a\0", "dem.nc", "DEM.NC", "dem-fields"]
)
def test_a_variant_cannot_name_what_is_not_a_folder_of_its_own(scene, name):
    path = scene()
    text = path.read_text() + f"[[variants]]\nname = {name!r}\n".replace("'", '"')
    path.write_text(text.replace("\\x00", "\\u0000"))
    with pytest.raises(SceneError, match=r"variants\[0\]\.name"):
        load(path)


def planned(scene, out):
    return plan(load(scene()), [("dem", None)], out)


@pytest.mark.parametrize("kind", ["text", "folder"])
def test_a_file_that_is_no_result_is_not_replaced(scene, tmp_path, kind):
    taken = tmp_path / "dem.nc"
    taken.mkdir() if kind == "folder" else taken.write_text("my diary")
    with pytest.raises(SceneError, match="would be replaced: choose another --out"):
        planned(scene, tmp_path)


def test_a_result_and_a_link_are_replaced_but_not_what_it_leads_to(scene, tmp_path):
    """What is written goes to the name; a link there is replaced, and its target stays."""
    from compare.output import write

    diary, link = tmp_path / "diary", tmp_path / "dem.nc"
    diary.write_text("my diary")
    link.symlink_to(diary)
    assert planned(scene, tmp_path)[0].path == link
    write(link, lambda path: path.write_bytes(b"CDF\2"))
    assert diary.read_text() == "my diary" and not link.is_symlink()
    refuse_foreign(link)


def test_a_folder_with_other_files_is_not_replaced(tmp_path):
    """As snapshots are written beside a result: NAME-fields is theirs, with their files alone."""
    place = tmp_path / "dem-fields"

    def save(new):
        new.mkdir()
        (new / "0000.vtu").write_text("new")

    for _ in range(2):
        write_folder(place, save)
    (place / "thesis.tex").write_text("my thesis")
    with pytest.raises(SceneError, match=r"thesis\.tex: is not a result and would be replaced"):
        write_folder(place, save)
    assert {p.name for p in place.iterdir()} == {"0000.vtu", "thesis.tex"}
    assert [p.name for p in tmp_path.iterdir()] == ["dem-fields"]

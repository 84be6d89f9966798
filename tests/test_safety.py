"""What a scene may not do: run code, leave its folder, replace a file that is not a result."""

import ast
import csv
import os
import re
import resource
import subprocess
import sys
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure

from jointwave import cases
from jointwave.cases.errors import SceneError, printable
from jointwave.cases.files import is_number
from jointwave.cases.read import load, load_variant
from jointwave.cases.schema.values import CONTROL
from jointwave.compare.cli import program, terminal
from jointwave.compare.figures.export import save
from jointwave.compare.runs.jobs import plan
from jointwave.compare.runs.output import refuse_foreign, write, write_csv
from jointwave.compare.studies.study import load as load_study

ROOT = Path(cases.__file__).parents[1]
PACKAGES = ("cases", "results", "numerics", "joints", "dem", "continuum", "compare")
SOURCES = [p for package in PACKAGES for p in sorted((ROOT / package).rglob("*.py"))]

#: Calls that make code of data, and modules that do.
CALLS = {"eval", "exec", "compile", "__import__"}
OWNED = {"os": {"system", "popen"}, "importlib": {"import_module"}, "builtins": CALLS}
OWNED["joblib"] = {"load", "Memory"}  # of files, by pickle
MODULES = {"pickle", "cPickle", "dill", "cloudpickle", "marshal", "shelve", "yaml"}

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
MASS = """
title = "mass"
domain = { mesh = "MESH" }
rock = { density = 2600.0, intact_modulus = 5e10 }
time = { duration = 0.001 }
record = { points = [[0.5, 0.5]] }
"""
#: Modules that print what is safe already, and what it is.
PRINTED = {
    "compare/runs/processes.py",  # a message of compare/cli/program.py, which made it printable
    "compare/cli/terminal.py",  # JSON, dumped the line before
}
HISTORY = "0,0\n1,1\n"


def faults_of(text):
    """Yield what of a module makes code of data, or hands a text to a shell."""
    for node in ast.walk(ast.parse(text)):
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


def raw_prints_of(text):
    """Yield what a module prints that is no constant and has not gone through `printable`, nor is
    JSON or a line made of it."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "print":
            calls = [n.func for n in ast.walk(node) if isinstance(n, ast.Call) and n is not node]
            names = {getattr(one, "id", getattr(one, "attr", "")) for one in calls}
            constant = all(isinstance(a, ast.Constant) for a in node.args)
            if not constant and not names & {"printable", "dumps", "version"}:
                yield ast.unparse(node)


@pytest.mark.parametrize(
    "text, search, fault",
    [
        ("eval('1')", faults_of, "eval"),
        ("import pickle", faults_of, "pickle"),
        ("from yaml import load", faults_of, "yaml"),
        ("subprocess.run('ls', shell=True)", faults_of, "shell or allow_pickle"),
        ("np.load(f, allow_pickle=True)", faults_of, "shell or allow_pickle"),
        ("os.system('ls')", faults_of, "system"),
        ("joblib.load(file)", faults_of, "load"),
        ("re.compile('x')", faults_of, None),
        ("print(title)", raw_prints_of, "print(title)"),
        ("print(printable(title), 'a')", raw_prints_of, None),
    ],
)
def test_the_search_finds_what_it_should(text, search, fault):
    assert next(search(text), None) == fault


@pytest.mark.parametrize(("search", "allowed"), [(faults_of, set()), (raw_prints_of, PRINTED)])
def test_no_module_makes_code_of_data_or_prints_what_is_not_printable(search, allowed):
    """Nothing that reads or runs a scene makes code of data; of what the commands print every line
    was made printable."""
    texts = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for path in SOURCES}
    found = {path: faults for path, text in texts.items() if (faults := list(search(text)))}
    assert found.keys() <= allowed, found


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


AWAY = ["../outside.csv", "away.csv", "out/outside.csv", "below/../../outside.csv"]
NO_FILES = {file: "is outside the scene's folder" for file in AWAY}
NO_FILES |= dict.fromkeys(("/dev/zero", "/proc/self/environ", "/etc"), "is outside the scene's fol")
NO_FILES |= {"pipe.csv": "not a regular file", "below": "is a directory", "": "is a directory"}
NO_FILES |= {"loop.csv": "cannot be read", "x" * 5000: "cannot be read"}


@pytest.mark.parametrize("file", NO_FILES, ids=lambda file: file[:30])
def test_what_is_outside_or_no_file_is_refused(scene, file):
    with pytest.raises(SceneError, match=rf"load\.file.*{NO_FILES[file]}"):
        load(scene(file))
    if NO_FILES[file] == "cannot be read":
        with pytest.raises(SceneError, match=r"numerics\.continuum\.mesh.*cannot be read"):
            load(scene(mesh=file))


def test_a_mesh_outside_the_scenes_folder_is_refused_unless_a_user_names_it(scene, tmp_path):
    """That of a rock mass is opened then, and found to be no mesh."""
    with pytest.raises(SceneError, match=r"numerics\.continuum\.mesh.* is outside the scene's"):
        load(scene(mesh="../outside.msh"))
    outside = str(tmp_path / "outside.msh")
    found = load_variant(scene(mesh="below.msh"), "", {"numerics.continuum.mesh": outside})
    assert found.numerics.continuum.mesh_path == tmp_path / "outside.msh"
    path = tmp_path / "scene" / "mass.toml"
    path.write_text(MASS.replace("MESH", outside))
    with pytest.raises(SceneError, match=r"domain\.mesh.* is outside the scene's folder"):
        load(path)
    for asked in ({"domain.mesh": outside}, {"domain": {"mesh": outside}}):
        with pytest.raises(SceneError, match=r"domain\.mesh.* cannot be read as a gmsh mesh"):
            load_variant(path, "", asked)


def test_a_user_may_name_a_load_anywhere_but_no_study(scene, tmp_path):
    """By --set, of the key or of the whole table; not by some other key."""
    file = str(tmp_path / "outside.csv")
    assert load(scene("gone.csv"), {"load.file": file})[0].load.history is not None
    table = {"shape": "table", "amplitude": 1.0, "file": file}
    assert load_variant(scene("gone.csv"), "", {"load": table}).load.history is not None
    with pytest.raises(SceneError, match="is outside the scene's"):
        load(scene(file), {"load.amplitude": 2.0})
    place = tmp_path / "study.toml"
    curve = '[[curves]]\nlabel = "a"\nmethod = "dem"'
    changes = f'changes = {{ "load.file" = "{file}" }}'
    place.write_text(f'title = "s"\nscene = "{scene("gone.csv")}"\n{changes}\n{curve}\n')
    with pytest.raises(SceneError, match="is outside the scene's"):
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


def test_only_a_result_is_replaced_and_never_what_a_link_leads_to(scene, tmp_path):
    """What is written goes to the name; a link there is replaced, and its target stays."""
    diary, link, folder = tmp_path / "diary", tmp_path / "dem.nc", tmp_path / "folder"
    diary.write_text("my diary")
    folder.mkdir()
    for taken in (diary, folder):
        taken.rename(link)
        with pytest.raises(SceneError, match="would be overwritten: choose another --out"):
            planned(scene, tmp_path)
        link.rename(taken)
    link.symlink_to(diary)
    assert planned(scene, tmp_path)[0][0].path == link
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
        write(place, save)
    (place / "thesis.tex").write_text("my thesis")
    with pytest.raises(SceneError, match=r"thesis\.tex: is not a result and would be overwritten"):
        write(place, save)
    assert {p.name for p in place.iterdir()} == {"0000.vtu", "thesis.tex"}
    assert [p.name for p in tmp_path.iterdir()] == ["dem-fields"]


#: What a hostile text is made of: escape sequences, C0, DEL, C1, marks of direction, markup, XML.
HOSTILE = st.text(
    st.one_of(
        st.sampled_from("\x1b\x00\x07\x08\r\n\t\x7f\x9b\x85\u202e\u2066\u200f\ufeff\ud800"),
        st.sampled_from("=+-@[]/:;,\"'<>&$\\_^{}"),
        st.characters(),
    ),
    max_size=20,
)
OFTEN = settings(max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture])
ESCAPES = "\x1b]0;owned\x07 \x1b[2J\x9b31m \x7f\u202e[red]:smile:"


@OFTEN
@given(text=HOSTILE)
def test_a_text_of_others_is_one_line_of_what_can_be_seen(text, capfd):
    """No control character of titles, names, keys or messages reaches the terminal, in any kind of
    answer; markup is text."""
    found = printable(text)
    assert found.isprintable() and printable(found) == found
    assert found == text or not text.isprintable()
    capfd.readouterr()
    terminal.say(f"{text}[red]:smile:")
    terminal.show_table([text, "b"], [[text, text]])
    terminal.print_json({text: text})
    out = capfd.readouterr().out
    assert not CONTROL.search(out) and "[red]:smile:" in out


def test_a_title_is_text_in_a_drawing(tmp_path):
    """Neither markup nor mathematics: as it stands in the SVG's title, and nowhere an element."""
    title = 'costs $5 <b>&amp; $x_{ ]]> <script>alert(1)</script> "q" \''
    figure = Figure()
    figure.subplots().plot([0, 1])
    drawn = save(figure, tmp_path, "a", title, png=False)
    found = ElementTree.parse(drawn.file("svg")).getroot()
    svg = "{http://www.w3.org/2000/svg}"
    assert found.findtext(f"{svg}title") == title
    assert not [e for e in found.iter() if e.tag.removeprefix(svg) in ("script", "b")]


@pytest.mark.parametrize("key", ["title", "source", "variants[0].name"])
@pytest.mark.parametrize("text", ["\x1b[31mred", "a\x7f", "\x9b2J", "ab\u202edc", "\u2066", "\0"])
def test_a_scene_has_no_control_characters_in_its_texts(scene, key, text, in_toml):
    tables = tomllib.loads((path := scene()).read_text())
    tables |= {"variants": [{"name": text}]} if "name" in key else {key: text}
    path.write_text(in_toml(tables).replace("\x7f", "\\u007f"))
    with pytest.raises(SceneError, match=f"{re.escape(key)}.*control character") as error:
        load(path)
    assert str(error.value).isprintable()


@pytest.mark.parametrize(
    "arguments",
    [
        ("explain", ESCAPES),
        (ESCAPES,),
        ("explain", "guo-li-2002/fig-03", "--set", f"{ESCAPES}=1"),
        ("explain", "guo-li-2002/fig-03", "--set", f"title={ESCAPES}"),
        ("explain", "guo-li-2002/fig-03", "--variant", ESCAPES),
        ("compare", "guo-li-2002/fig-03", f"--{ESCAPES}"),
    ],
)
def test_a_mistake_is_told_without_its_escape_sequences(jointwave, arguments):
    out, error = jointwave(*arguments, code=2)
    assert not out and error.count("\n") == 1
    assert error[:-1].isprintable() and "jointwave: " in error


UNNAMED = UnicodeEncodeError("ascii", "\xe9.nc", 0, 1, "x")
FULL = OSError(28, "No space left on device", "x.png")


@pytest.mark.parametrize(
    "raised, code, words",
    [
        (KeyError("no\nsuch"), 1, "internal error, KeyError at test_safety.py"),
        (RecursionError("deep"), 1, "internal error, RecursionError"),
        (UNNAMED, 2, "'.xe9.nc': cannot be encoded in the locale's ascii"),
        (FULL, 2, "x.png: No space left on device"),
        (MemoryError("much"), 2, "not enough memory: much"),
    ],
)
def test_whatever_goes_wrong_is_one_line(monkeypatch, capsys, jointwave, raised, code, words):
    def run(arguments):
        raise raised

    monkeypatch.setattr(program, "run", run)
    out, error = jointwave("list", code=code)
    assert not out and error.count("\n") == 1 and re.search(words, error)
    if code == 1:
        monkeypatch.setenv(program.SHOWN, "1")
        with pytest.raises(SystemExit):
            program.main()
        assert "Traceback (most recent call last)" in capsys.readouterr().err


#: How a command is started whose streams are closed or of a locale without the letters.
STREAMS = {
    "all closed": ("<&- >&- 2>&-", 0),
    "output that nobody reads": ("| head -c0", 1),
    "error that nobody reads": ("--bogus 2>&1 >/dev/null | head -c0", 2),
}


@pytest.mark.parametrize("name", STREAMS)
def test_streams_that_take_nothing_are_no_fault(name):
    """What is written must not go into a file that was opened in a closed stream's place."""
    how, code = STREAMS[name]
    command = f"set -o pipefail; {sys.executable} -m jointwave list {how}"
    error = subprocess.PIPE if "2>" not in how else None
    done = subprocess.run(["bash", "-c", command], stdout=subprocess.PIPE, stderr=error, text=True)
    assert done.returncode == code and not done.stdout
    assert not done.stderr


@pytest.mark.parametrize("utf8", ["1", "0"])
def test_a_locale_without_the_letters_spells_them(scene, without_warnings, utf8):
    """Where it cannot even name the variant's folder, that is one line."""
    path = scene()
    path.write_text(path.read_text() + '[[variants]]\nname = "\u00b5 = 0.5 \u2013 \u7075"\n')
    locale = {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": utf8}
    command = [sys.executable, "-m", "jointwave", "run", str(path), "--out", str(path.parent / "o")]
    environment = os.environ | locale | {"PYTHONIOENCODING": "ascii"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    if utf8 == "1":
        assert (done.returncode, without_warnings(done.stderr)) == (0, [])
        assert "\\xb5 = 0.5 \\u2013" in done.stdout
    else:
        (line,) = without_warnings(done.stderr)
        assert done.returncode == 2
        assert "\\xb5 = 0.5 \\u2013" in line and "PYTHONUTF8=1" in line


def test_a_full_disk_is_named_with_the_file(tmp_path):
    """Of each of a figure's writers, whatever they say, and nothing is left behind."""
    figure = Figure()
    figure.subplots().plot([0, 1])
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    table = pd.DataFrame({"a": range(3)})
    for size, suffix in ((1, "csv"), (1000, "svg")):
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
        try:
            with pytest.raises(OSError, match="File too large") as error:
                save(figure, tmp_path, "a", "title", table)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        assert error.value.filename == str(tmp_path / f"a.{suffix}")
    assert {path.name for path in tmp_path.iterdir()} == {"a.csv"}

    def encode(path):
        raise OSError("encoder error -2 when writing image file")

    with pytest.raises(OSError, match="encoder error") as error:
        write(tmp_path / "a.png", encode)
    assert error.value.filename == str(tmp_path / "a.png") and error.value.errno


@OFTEN
@given(cells=st.lists(HOSTILE, min_size=1, max_size=4), number=st.floats(allow_nan=False))
def test_no_cell_of_a_table_is_a_formula(tmp_path_factory, cells, number):
    """Numbers stay numbers, and text that is none stays to be read, as one line a row."""
    path = tmp_path_factory.mktemp("csv") / "a.csv"
    table = pd.DataFrame({"text": cells, "number": number, "count": -1})
    write_csv(path, table.rename(columns={"text": cells[0]}), 17)
    with path.open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert len(rows) == len(cells)
    for text, cell in zip([cells[0], *cells], [header[0], *(row[0] for row in rows)], strict=True):
        assert not cell.startswith(("=", "+", "-", "@")) or is_number(cell)
        assert cell.isprintable() and cell.removeprefix("'") == printable(text).removeprefix("'")
    assert {float(row[1]) for row in rows} == {number} and {row[2] for row in rows} == {"-1"}

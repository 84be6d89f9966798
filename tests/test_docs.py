"""The documentation and the README: complete where generated, true where they show something."""

import re
import shlex
from pathlib import Path

import pytest
from PIL import Image

from jointwave import cases
from jointwave.cases.schema.keys import keys as all_keys
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.engines import EXACT, solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.studies.findings import judged, orders
from jointwave.compare.studies.study import load
from jointwave.compare.studies.work_precision import experiment
from jointwave.results.dataset import TERMS

ROOT = Path(__file__).parents[1]
DOCS, README, GALLERY = ROOT / "docs", ROOT / "README.md", ROOT / "docs" / "gallery"
PACKAGES = ("cases", "results", "numerics", "joints", "dem", "continuum", "compare")
PAGES = [README, *sorted(DOCS.rglob("*.md"))]
TEXTS = {page: page.read_text(encoding="utf-8") for page in PAGES}
BLOCK = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```", re.MULTILINE | re.DOTALL)
#: Places that mean something on one machine alone, and words that a reader cannot act upon.
FORBIDDEN = ("/tmp/", "/home/", "TODO", "FIXME", "TBD", "lorem ipsum")
NAMES = sorted(path.stem for path in GALLERY.glob("*.md") if path.stem != "index")
#: Pages of the gallery with rock masses by both engines: ten seconds to a minute each.
SLOW = {"tunnel", "blast-hole", "slope", "layers", "cavern", "masonry-wall", "wedge", "own-rock"}
LARGEST, FILM = 80_000, 400_000  # bytes of a picture, and of a film


def name_of(page):
    return page.relative_to(ROOT).as_posix()


def block(page, language):
    """Return the first block of code of a page in this language."""
    return next(text for found, _, text in BLOCK.findall(TEXTS[page]) if found == language)


@pytest.fixture
def tools(modules_of):
    """Return a function that imports one module of tools/docs."""
    return modules_of(ROOT / "tools" / "docs")


@pytest.fixture
def folder(tmp_path, monkeypatch, modules_of):
    """Return an empty folder, the current one, whose modules can be imported."""
    monkeypatch.chdir(tmp_path)
    modules_of(tmp_path)
    return tmp_path


#: Pages with code that have no tests of their own.
WITH_CODE = [
    page
    for page, text in TEXTS.items()
    if "```python" in text and page.parent != GALLERY and page != README
]


@pytest.mark.parametrize("page", WITH_CODE, ids=name_of)
def test_python_of_a_page_runs(page, folder):
    """Block after block, beside the files that the page shows; they assert what they say."""
    space: dict = {}
    for found in BLOCK.finditer(TEXTS[page]):
        language, title, code = found.groups()
        if title:
            (folder / title).write_text(code, encoding="utf-8")
        elif language == "python":
            line = TEXTS[page].count("\n", 0, found.start()) + 1
            exec(compile("\n" * line + code, str(page), "exec"), space)
    assert "assert " in TEXTS[page]


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_a_page_names_only_what_there_is(page, folder, tools):
    """Its scenes can be loaded; links, files, modules, commands and their options exist."""
    text = TEXTS[page]
    for _, title, shown in BLOCK.findall(text):
        if title:
            (folder / title).write_text(shown, encoding="utf-8")
    assert all(cases.load(path) for path in folder.glob("*.toml"))
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if not link.startswith(("http", "#", "mailto:")):
            assert (page.parent / link.partition("#")[0]).exists(), link
    named = re.findall(r"`((?:cases|joints|dem|continuum|compare|tests)/[\w/.-]*)`", text)
    assert not [path for path in named if not (ROOT / path).exists()]
    if page.name == "exact.md":
        folders = ROOT / "compare/exact", ROOT / "tests/theory"
        there = {path.name for folder in folders for path in folder.rglob("*.py")}
        assert {*re.findall(r"`(\w+\.py)`", text)} <= there
    commands = tools("commands")
    known = commands.all_commands()
    for line in re.findall(r"^ {4}(?:mpiexec -n \d+ )?jointwave (\S.*)$", text, re.MULTILINE):
        name, *rest = shlex.split(line, comments=True)
        assert {w for w in rest if w.startswith("--")} <= {*commands.options(known[name])}, line
    targets = re.findall(r"^([a-z0-9-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert {*re.findall(r"`make ([a-z0-9-]+)`", text)} <= {*targets}


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_a_page_is_finished(page, tools):
    """No words of the unfinished; braces of formulas match, since one too few is no error to the
    converter; every mark of a generated part makes one, written by `make docs`."""
    text, hooks = TEXTS[page], tools("hooks")
    assert not [word for word in FORBIDDEN if word in text]
    for shown, inline in re.findall(r"\$\$(.+?)\$\$|\$([^$\n]+)\$", BLOCK.sub("", text), re.DOTALL):
        formula = re.sub(r"\\[{}]", "", shown or inline)
        assert formula.count("{") == formula.count("}"), formula
    assert text.count("<!-- generated") == len(hooks.MARK.findall(text))
    assert "<!-- generated" not in hooks.generated(text)
    if page.parent.name == "reference" and page.name != "result.md":
        assert text == hooks.written_out(text) and "<!-- end -->" in text


def test_reference_has_every_key():
    """Each key of every model, with what it allows and what it means; each term of a ledger; each
    exact solution by the name that users type."""
    text = TEXTS[DOCS / "reference" / "scene.md"]
    rows = [f'id="key-{key}"' for key, _ in all_keys()]
    rows += [f'id="rock-key-{key}"' for key, _ in all_keys(RockMass)]
    assert len(rows) == len(set(rows)) > 120 and not [row for row in rows if row not in text]
    assert not re.findall(r'^.*id="(?:rock-)?key.*\|  \|$', text, re.MULTILINE)
    page = TEXTS[DOCS / "reference" / "result.md"]
    assert not [term for term in TERMS if f"`{term}`" not in page]
    headings = re.findall(r"^#+ .*", TEXTS[DOCS / "theory" / "exact.md"], re.MULTILINE)
    assert not [name for name in EXACT if not any(f"`{name}`" in h for h in headings)]


def test_a_new_parameter_passes_through_the_files_that_are_listed():
    """The list to copy names every file that knows the parameter which it is copied from."""
    page = TEXTS[DOCS / "extend.md"].partition("### A new parameter")[2]
    listed = set(re.findall(r"^\| `([\w/]+\.py)`", page, re.MULTILINE))
    files = [f for name in PACKAGES for f in (ROOT / name).rglob("*.py")]
    naming = [f for f in files if "weakening_distance" in f.read_text(encoding="utf-8")]
    assert listed == {name_of(file) for file in naming}


def test_what_theory_cites_is_among_the_sources():
    """Author and year of every citation stand in one row of the sources."""
    cited = re.compile(r"([A-Z][\w-]+)(?:'s)?(?: et al\.)?,?\s+\(?((?:18|19|20)\d\d)\b")
    rows = TEXTS[DOCS / "theory" / "sources.md"].splitlines()
    texts = [t for p, t in TEXTS.items() if p.parent.name == "theory" or p.name == "extend.md"]
    found = {c for text in texts for c in cited.findall(text)}
    assert len(found) > 30
    assert not [c for c in found if not any(c[0] in row and c[1] in row for row in rows)]


def test_every_page_is_in_the_navigation():
    nav = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("nav:")[2]
    assert not [p for p in PAGES[1:] if f": {p.relative_to(DOCS).as_posix()}\n" not in nav]


def test_it_builds_without_warnings(folder):
    """As `make docs` builds it; every formula is MathML, and nothing is fetched to read a page."""
    pytest.importorskip("material")
    pytest.importorskip("latex2mathml")
    from mkdocs.commands.build import build
    from mkdocs.config import load_config

    build(load_config(str(ROOT / "mkdocs.yml"), site_dir=str(folder / "site"), strict=True))
    pages = list((folder / "site").rglob("*.html"))
    assert len(pages) > len(PAGES) - 1  # and that of errors
    for page in pages:
        html = page.read_text(encoding="utf-8")
        assert "arithmatex" not in html
        fetched = re.findall(r'<(?:script|img|iframe)[^>]+src="(http[^"]+)"', html)
        fetched += re.findall(r'<link[^>]+rel="(?:stylesheet|preconnect)"[^>]+"(http[^"]+)"', html)
        assert not fetched, page
    assert "<math" in (folder / "site" / "theory" / "exact.html").read_text(encoding="utf-8")


@pytest.fixture
def scene_file(folder):
    """Return the README's scene as a file of the current folder."""
    (folder / "my-scene.toml").write_text(block(README, "toml"), encoding="utf-8")
    return folder / "my-scene.toml"


def test_the_scene_of_the_readme_meets_its_own_expectations(scene_file):
    scenes = cases.load(scene_file)
    assert [scene.name for scene in scenes] == ["", "no layer"]
    for scene in scenes:
        for pair, bound in scene.expect.items():
            one, other = (solve(name, scene) for name in pair.split(" ~ "))
            assert misfit(one, other) <= bound


def test_the_study_of_the_guide_runs_on_it(scene_file):
    """Every point is done, at the order that it says."""
    path = scene_file.with_name("my-study.toml")
    path.write_text(block(DOCS / "how-to" / "study.md", "toml"), encoding="utf-8")
    study = load(str(path))
    rows = experiment(study, scene_file.parent / "points").rows()
    assert [row["state"] for row in rows] == ["done"] * 3
    (order,) = orders(study, judged(rows))
    assert order.measured == pytest.approx(order.theory, abs=0.1)


def test_python_of_the_readme_prints_what_it_says(scene_file, capsys):
    exec(compile(block(README, "python"), "README.md", "exec"), {})
    assert 0 < float(capsys.readouterr().out.split()[0]) < 0.02
    assert (scene_file.parent / "waveforms.png").stat().st_size > 10_000


def test_the_readme_has_the_numbers_of_the_free_pillar(pillar):
    """The table: 0.1, 4.0 and 17.9 %, to the digits given; it is read in one go."""
    scene = pillar()
    dem = solve("dem", scene)
    for name, percent in (("lattice", 0.1), ("jointed-bar", 4.0), ("equivalent-bar", 17.9)):
        assert f"`{name}`" in TEXTS[README] and f"{percent} %" in TEXTS[README]
        assert 100 * misfit(dem, solve(name, scene)) == pytest.approx(percent, abs=0.05)
    assert TEXTS[README].count("\n") <= 120


@pytest.mark.slow
def test_the_first_picture_is_made_by_its_commands(jointwave, folder):
    """Both lines below it, run as they stand."""
    for line in re.findall(r"^    jointwave ((?:run|picture) .*tunnel)$", TEXTS[README], re.M):
        jointwave(*shlex.split(line))
    assert (folder / "tunnel.png").stat().st_size > 50_000


@pytest.mark.parametrize("name", NAMES)
def test_a_page_of_the_gallery_shows_the_scene_that_is_kept(tools, name):
    page = tools("gallery").read(GALLERY / f"{name}.md")
    assert page.shown == page.kept and f'jw.load("{page.file}"' in page.code
    drawn = {GALLERY / one for one in page.pictures}
    assert all(one.stat().st_size < (FILM if one.suffix == ".gif" else LARGEST) for one in drawn)
    assert len(NAMES) == 14 and f"({name}.md)" in TEXTS[GALLERY / "index.md"]


@pytest.mark.parametrize(
    "name", [pytest.param(one, marks=pytest.mark.slow if one in SLOW else ()) for one in NAMES]
)
def test_the_lines_of_a_page_of_the_gallery_draw_its_pictures(tools, name, tmp_path):
    """As large as those that are kept."""
    gallery = tools("gallery")
    page = gallery.read(GALLERY / f"{name}.md")
    gallery.run(page, tmp_path)
    for one in (one for one in page.pictures if one.endswith(".png")):
        with Image.open(tmp_path / one) as made, Image.open(GALLERY / one) as kept:
            assert made.size == kept.size
            assert len(made.convert("RGB").getcolors(1_000_000)) > 20

"""The documentation: complete where it is generated, its links lead somewhere, its Python runs."""

import re
import shlex
from pathlib import Path

import pytest

from jointwave.cases.schema.keys import field_comments, in_words
from jointwave.cases.schema.keys import keys as all_keys
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
TOOLS = ROOT / "tools" / "docs"
PACKAGES = ("cases", "results", "numerics", "joints", "dem", "continuum", "compare")
PAGES = sorted(DOCS.rglob("*.md"))
BLOCK = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```", re.MULTILINE | re.DOTALL)
#: Places that mean something on one machine alone, and words that a reader cannot act upon.
FORBIDDEN = ("/tmp/", "/home/", "TODO", "FIXME", "TBD", "lorem ipsum")


def name_of(page):
    return page.relative_to(DOCS).as_posix()


def blocks(page):
    """Return (language, title, text) of a page's fenced blocks."""
    return BLOCK.findall(page.read_text(encoding="utf-8"))


@pytest.fixture
def tools(modules_of):
    """Return a function that imports one module of tools/docs."""
    return modules_of(TOOLS)


@pytest.fixture
def folder(tmp_path, monkeypatch, modules_of):
    """Return an empty folder, the current one, whose modules can be imported."""
    monkeypatch.chdir(tmp_path)
    modules_of(tmp_path)
    return tmp_path


#: Those with code; pages of the gallery have tests of their own.
WITH_CODE = [p for p in PAGES if "```python" in p.read_text() and p.parent.name != "gallery"]


@pytest.mark.parametrize("page", WITH_CODE, ids=name_of)
def test_python_of_a_page_runs(page, folder):
    """Block after block, beside the files that the page shows; they assert what they say."""
    space: dict = {}
    text = page.read_text(encoding="utf-8")
    for found in BLOCK.finditer(text):
        language, title, code = found.groups()
        if title:
            (folder / title).write_text(code, encoding="utf-8")
        elif language == "python":
            line = text.count("\n", 0, found.start()) + 1
            exec(compile("\n" * line + code, str(page), "exec"), space)
    assert any("assert " in text for language, _, text in blocks(page) if language == "python")


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_scenes_of_a_page_are_scenes(page, folder):
    """Every TOML file that a page shows is one that can be simulated, with the files beside it."""
    from jointwave import cases

    for _, title, text in blocks(page):
        if title:
            (folder / title).write_text(text, encoding="utf-8")
    for path in folder.glob("*.toml"):
        assert cases.load(path)


def test_reference_has_every_key(tools):
    """Each key of every model is in the page, with what it allows and what it means."""
    page = tools("hooks").generated
    text = page((DOCS / "reference" / "scene.md").read_text(encoding="utf-8"))
    keys = [key for key, _ in all_keys()]
    of_rock_masses = [key for key, _ in all_keys(RockMass)]
    assert len(keys) == len(set(keys)) > 60 < len(of_rock_masses) == len(set(of_rock_masses))
    missing = [key for key in keys if f'id="key-{key}"' not in text]
    missing += [key for key in of_rock_masses if f'id="rock-key-{key}"' not in text]
    assert not missing
    assert not re.findall(r'^.*id="(?:rock-)?key.*\|  \|$', text, re.MULTILINE)
    assert {"pillar.length", "soft_layers.y", "numerics.continuum.mesh"} <= set(keys)


def test_reference_follows_the_models(tools):
    """Default, constraint and comment of a key stand in its row as the model has them."""
    rows = tools("scene_reference").page().splitlines()
    row = next(r for r in rows if 'id="key-numerics.continuum.spectral_radius"' in r)
    assert row.endswith("| number ≥ 0 and ≤ 1 | `0.9` | implicit: at infinite frequency |")
    law = field_comments(type(Scene.model_fields["joints"].default))
    assert "c_n = 2 zeta sqrt(m k_n)" in law["damping_ratio"]  # of the model that it extends
    motion = field_comments(Scene.model_fields["motion"].annotation)
    assert motion["rotation"].endswith("vectors; finite: quaternions")  # a comment of two lines


def test_a_check_without_words_is_refused():
    """A validator that the reference cannot put into words stops it."""
    from typing import Annotated

    from pydantic import AfterValidator, BaseModel

    class Model(BaseModel):
        key: Annotated[float, AfterValidator(abs)]

    with pytest.raises((KeyError, AttributeError)):
        in_words(Model.model_fields["key"])


def test_every_exact_solution_is_explained():
    """Theory has a heading for each exact solution, by the name that users type."""
    from jointwave.compare.engines import EXACT

    headings = re.findall(r"^#+ .*", (DOCS / "theory" / "exact.md").read_text(), re.MULTILINE)
    assert not [name for name in EXACT if not any(f"`{name}`" in h for h in headings)]


def test_every_term_and_quantity_of_a_result_is_explained():
    """The page on results names all terms of the ledger."""
    from jointwave.results.dataset import ALL_TERMS

    page = (DOCS / "reference" / "result.md").read_text(encoding="utf-8")
    assert not [term for term in ALL_TERMS if f"`{term}`" not in page]


def test_a_new_parameter_passes_through_the_files_that_are_listed():
    """The list to copy names every file that knows the parameter which it is copied from."""
    page = (DOCS / "extend.md").read_text(encoding="utf-8").partition("### A new parameter")[2]
    listed = set(re.findall(r"^\| `([\w/]+\.py)`", page, re.MULTILINE))
    files = [f for name in PACKAGES for f in (ROOT / name).rglob("*.py")]
    naming = [f for f in files if "weakening_distance" in f.read_text(encoding="utf-8")]
    assert listed == {f.relative_to(ROOT).as_posix() for f in naming}


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_files_that_a_page_names_are_there(page):
    """Paths into the packages, and names of modules in the sections that begin with Files."""
    text = page.read_text(encoding="utf-8")
    named = re.findall(r"`((?:cases|joints|dem|continuum|compare|tests)/[\w/.-]*)`", text)
    assert not [path for path in named if not (ROOT / path).exists()]
    if page.name == "exact.md":
        solutions = re.findall(r"`(\w+\.py)`", text)
        folders = ROOT / "compare/exact", ROOT / "tests/theory"
        there = {path.name for folder in folders for path in folder.rglob("*.py")}
        assert not [name for name in solutions if name not in there]


def test_generated_parts_are_known(tools):
    """Every mark of every page names something that can be made, and makes it."""
    hooks = tools("hooks")
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        assert text.count("<!-- generated") == len(hooks.MARK.findall(text)), page
        assert "<!-- generated" not in hooks.generated(text)


@pytest.mark.parametrize("name", ["commands.md", "python.md", "scene.md"])
def test_reference_is_written_out(name, tools):
    """Who reads the file itself reads what is generated; `make docs` writes it."""
    text = (DOCS / "reference" / name).read_text(encoding="utf-8")
    assert text.count("<!-- end -->") == text.count("<!-- generated") > 0
    assert text == tools("hooks").written_out(text)


def test_api_reads_signatures_and_docstrings(tools):
    """A documented function stands with its arguments; entries of a docstring become a list."""
    api = tools("api")
    page = api.page(ROOT, "cases.read load")
    assert "path: str | Path" in page and "`overrides` maps dotted keys" in page
    renamed = api.page(ROOT, "cases.read as cases load")
    assert "### `cases.load`" in renamed and "overrides: dict[str, Any] | None = None" in renamed
    assert api.as_markdown("a : m. b, c : s.") == "- `a`: m.\n- `b, c`: s."
    assert api.as_markdown("Parameters\n----------\nx : m.") == "**Parameters**\n\n- `x`: m."


def test_formulas_become_mathml(tools):
    """Whatever theory says in LaTeX, as blocks and in lines, is converted whole."""
    pytest.importorskip("latex2mathml")
    html = tools("hooks").mathml(r'<span class="arithmatex">\(a &lt; b_1\)</span>')
    assert html.startswith("<math") and "arithmatex" not in html and "&#x0003C;" in html


def test_what_theory_cites_is_among_the_sources():
    """Author and year of every citation stand in one row of the sources."""
    cited = re.compile(r"([A-Z][\w-]+)(?:'s)?(?: et al\.)?,?\s+\(?((?:18|19|20)\d\d)\b")
    rows = (DOCS / "theory" / "sources.md").read_text(encoding="utf-8").splitlines()
    texts = [p.read_text(encoding="utf-8") for p in PAGES if p.parent.name == "theory"]
    texts.append((DOCS / "extend.md").read_text(encoding="utf-8"))
    found = {c for text in texts for c in cited.findall(text)}
    assert len(found) > 30
    assert not [c for c in found if not any(c[0] in row and c[1] in row for row in rows)]


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_braces_of_formulas_match(page):
    """A brace too few is no error to the converter, which then sets something else."""
    text = BLOCK.sub("", page.read_text(encoding="utf-8"))
    for shown, inline in re.findall(r"\$\$(.+?)\$\$|\$([^$\n]+)\$", text, re.DOTALL):
        formula = re.sub(r"\\[{}]", "", shown or inline)
        assert formula.count("{") == formula.count("}"), formula


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page):
    """Relative links of a page are files of the documentation."""
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if not link.startswith(("http", "#", "mailto:")):
            assert (page.parent / link.partition("#")[0]).exists(), link


def test_every_page_is_in_the_navigation():
    """A page that no menu leads to is not found."""
    nav = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("nav:")[2]
    assert not [name_of(page) for page in PAGES if f": {name_of(page)}\n" not in nav]


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_of_a_page_exist(page, tools):
    """Commands and options that a page shows are the program's own."""
    commands = tools("commands")
    known = commands.all_commands()
    text = page.read_text(encoding="utf-8")
    for line in re.findall(r"^ {4}(?:mpiexec -n \d+ )?jointwave (\S.*)$", text, re.MULTILINE):
        name, *rest = shlex.split(line, comments=True)
        options = [word for word in rest if word.startswith("--")]
        assert name in known, line
        assert set(options) <= set(commands.options(known[name])), line


def test_targets_of_make_exist():
    """What a page asks make for is in the Makefile."""
    targets = set(re.findall(r"^([a-z0-9-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    named = {t for page in PAGES for t in re.findall(r"`make ([a-z0-9-]+)`", page.read_text())}
    assert named and named <= targets


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_no_forbidden_words(page):
    """No place of one machine, nothing unfinished."""
    text = page.read_text(encoding="utf-8")
    assert not [word for word in FORBIDDEN if word in text]


def test_it_builds_without_warnings(folder):
    """As `make docs` builds it; every formula is MathML, and nothing is fetched to read a page."""
    pytest.importorskip("material")
    pytest.importorskip("latex2mathml")
    from mkdocs.commands.build import build
    from mkdocs.config import load_config

    build(load_config(str(ROOT / "mkdocs.yml"), site_dir=str(folder / "site"), strict=True))
    pages = list((folder / "site").rglob("*.html"))
    assert len(pages) > len(PAGES)  # and that of errors
    for page in pages:
        html = page.read_text(encoding="utf-8")
        assert "arithmatex" not in html
        fetched = re.findall(r'<(?:script|img|iframe)[^>]+src="(http[^"]+)"', html)
        fetched += re.findall(r'<link[^>]+rel="(?:stylesheet|preconnect)"[^>]+"(http[^"]+)"', html)
        assert not fetched, page
    assert "<math" in (folder / "site" / "theory" / "exact.html").read_text(encoding="utf-8")

"""The scene that `jointwave new` writes, every key explained: a pillar with a weak layer, or a wave
at a joint in a rock mass.

What a key means and allows is taken from the models that read it; only the values are ours.
"""

import inspect
import json
from collections.abc import Iterator
from pathlib import Path
from shlex import quote
from textwrap import wrap

import cases
from cases.errors import SceneError
from cases.schema.keys import TableOf, default_of, field_comments, in_words, model_in, tables
from compare.cli.templates import PILLAR, Template
from compare.runs.output import create
from compare.scenes import find, load

WIDTH = 100  # characters of a line


def write_new(name: str, source: str | None = None, template: Template = PILLAR) -> list[Path]:
    """Write a scene of this name, or a copy of the scene `source` with the files that it names.

    template : of the scene, where none is copied. Returns the files. Raises SceneError where one of
    them is there already: nothing is replaced.
    """
    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    if path.name.startswith((".", " ")) or not name.isprintable():
        raise SceneError("NAME", name, None, "must be a file name that does not begin with '.'")
    if source is None:
        return [create(path, starter(path, template).encode())]
    given = find(source)
    load(given)
    places = {path: given, **{path.parent / file: given.parent / file for file in _files(given)}}
    for place in places:
        if place.exists() or place.is_symlink():
            raise SceneError(str(place), "", None, "exists already: choose another NAME")
    return [create(place, original.read_bytes()) for place, original in places.items()]


def _files(scene: Path) -> list[str]:
    scenes = cases.load(scene)
    files = [pulse.file for one in scenes for pulse in one.pulses]
    files += [getattr(one.numerics.continuum, "mesh", None) for one in scenes]
    return [file for file in dict.fromkeys(files) if file is not None]


def starter(path: Path, template: Template = PILLAR) -> str:
    """Return a runnable scene, to be written at a path."""
    shown, folder = quote(path.name), quote(path.stem)
    begin = [
        f"Check: jointwave explain {shown}",
        f"Run:   jointwave compare {shown} --out {folder}",
    ]
    top = TableOf("", template.model, False)
    title = _key("title", json.dumps(path.stem), *_about(top, "title"))
    head = [*template.head.splitlines(), *begin]
    parts = [*(f"# {line}".rstrip() for line in head), "", title, ""]
    for table in tables("", template.model):
        every = (*template.given, *template.offered)
        if any(key.rpartition(".")[0] == table.path for key in every):
            parts += [*_table(table, template), ""]
    return "\n".join([*parts, template.tail.format(file=shown)])


def _table(table: TableOf, template: Template) -> Iterator[str]:
    given, offered = template.given, template.offered
    yield from (f"# {line}" for line in wrap(inspect.getdoc(table.model) or "", WIDTH - 2))
    names = [name for name, field in table.fields if not model_in(field.annotation)]
    wanted = [name for name in names if table.dotted(name) in {**given, **offered}]
    holds = any(table.dotted(name) in given for name in wanted)
    yield table.heading if holds else f"# {table.heading}"
    for name in wanted:
        key = table.dotted(name)
        value = given.get(key) or offered[key] or json.dumps(default_of(dict(table.fields)[name]))
        yield _key(name, value, *_about(table, name), chosen=key in given)


def _about(table: TableOf, name: str) -> tuple[str, str]:
    """Return what a key means, its unit first, and what it allows."""
    allowed = in_words(table.model.model_fields[name]).replace("`", "")
    several = '", "' in allowed
    return field_comments(table.model)[name], f"one of {allowed}" if several else allowed


def _key(name: str, value: str, meaning: str, allowed: str, chosen: bool = True) -> str:
    line = f"{'' if chosen else '# '}{name} = {value}"
    comment = f"{meaning}; {allowed}" if meaning else allowed
    beside = f"{line:<32}  # {comment}"
    if len(beside) <= WIDTH:
        return beside
    return "\n".join([*(f"#   {part}" for part in wrap(comment, WIDTH - 4)), line])

"""`jointwave list`, and `jointwave new`, which writes a template or a copy of a scene."""

import json
from pathlib import Path
from shlex import quote
from typing import Any

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.compare.cli import terminal
from jointwave.compare.cli.commands import List, New
from jointwave.compare.runs.output import create
from jointwave.compare.scenes import find, load_variants, shipped

TEMPLATES = Path(__file__).parent / "templates"
TITLE = "my-scene"  # title in the templates


def list_scenes(asked: List) -> None:
    """Print the shipped scenes and their variants."""
    facts: list[dict[str, Any]] = [
        {"scene": name, "title": base.title, "variants": [one.name for one in variants]}
        for name, (base, *variants) in ((name, cases.load(find(name))) for name in shipped())
    ]
    if asked.as_json:
        terminal.print_json(facts)
        return
    for one in facts:
        terminal.say_wrapped(f"{one['scene']}: {one['title']}", " " * 4)
        if one["variants"]:
            terminal.say_wrapped(f"    variants: {'; '.join(one['variants'])}", " " * 6)


def new(asked: New) -> None:
    """Write a scene and print its files."""
    if asked.rock_mass and asked.source is not None:
        raise SceneError("--rock-mass", "", None, "has no meaning with --from")
    template = "rock-mass" if asked.rock_mass else "pillar"
    for path in write_new(asked.name, asked.source, template):
        terminal.say(f"wrote {path}")


def write_new(name: str, source: str | None = None, template: str = "pillar") -> list[Path]:
    """Write a scene of this name, or a copy of the scene `source` with the files that it names.

    template : "pillar" or "rock-mass", if there is no source. Returns the files. Raises SceneError
    if one of them exists: nothing is replaced.
    """
    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    if path.name.startswith((".", " ")) or not name.isprintable():
        raise SceneError("NAME", name, None, "must be a file name that does not begin with '.'")
    if source is None:
        return [create(path, starter(path.name, template).encode())]
    given = find(source)
    scenes = load_variants(given)
    files = [pulse.file for one in scenes for pulse in one.pulses]
    tables = [at for one in scenes for at in (one.numerics.continuum, getattr(one, "domain", None))]
    files += [getattr(at, key, None) for at in tables for key in ("mesh", "blocks")]
    named = filter(None, files)
    places = {path: given, **{path.parent / file: given.parent / file for file in named}}
    for place in places:
        if place.exists() or place.is_symlink():
            raise SceneError(str(place), "", None, "exists already: choose another NAME")
    return [create(place, original.read_bytes()) for place, original in places.items()]


def starter(file: str, template: str = "pillar") -> str:
    """Return a template's text with title and commands adapted to a file name."""
    text, stem = (TEMPLATES / f"{template}.toml").read_text(encoding="utf-8"), Path(file).stem
    text = text.replace(f'"{TITLE}"', json.dumps(stem), 1).replace(f"{TITLE}.toml", quote(file))
    return text.replace(f"--out {TITLE}", f"--out {quote(stem)}")

"""The scene that `jointwave new` writes: a short pillar with a weak layer, every key explained.

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
from cases.schema.allowed import in_words, model_in
from cases.schema.field_docs import field_comments
from cases.schema.keys import TableOf, default_of, tables
from cases.schema.scene import Scene
from cases.validate import FILE_KEYS
from compare.runs.output import create
from compare.scenes import find, load

WIDTH = 100  # characters of a line

#: The keys that are set, as a file spells them.
SET = {
    "pillar.length": "20.0",
    "pillar.side": "0.5",
    "pillar.block": "0.5",
    "rock.density": "2400.0",
    "rock.p_speed": "2200.0",
    "rock.s_speed": "800.0",
    "rock.intact_modulus": "8.64e10",
    "rock.intact_poisson": "0.25",
    "soft_layers.y": "8.0",
    "soft_layers.spacing_stiffness": "4.375e8",
    "load.shape": '"ricker"',
    "load.amplitude": "1.0e6",
    "load.period": "0.01",
    "ends.start": '"matched"',
    "ends.end": '"matched"',
    "time.duration": "0.05",
    "record.stress": "[4.0, 12.0]",
    "record.velocity": "[4.25]",
}

#: Keys that stand there to be chosen, with an example where they have no default.
OFFERED = {
    "rock.equivalent_modulus": "4.26e9",
    "rock.equivalent_poisson": "0.42",
    "joints.damping_ratio": "0.02",
    "joints.tension": "false",
    "joints.friction_angle": "30.0",
    "joints.cohesion": "1.0e5",
    "joints.normal_stiffness": "9.0e9",
    "soft_layers.damping_ratio": "0.02",
    "soft_layers.thickness": "0.05",
    "load.quantity": "",
    "load.cycles": "2",
    "load.file": '"load.csv"',
    "load.direction": "",
    "load.at": "",
    "gravity.direction": "[0, 1, 0]",
    "gravity.acceleration": "",
    "gravity.static": "false",
    "prestress.normal": "1.0e5",
    "record.interval": "5.0e-5",
    "record.fields": "1.0e-3",
    "record.energy": "",
    "numerics.dem.step_fraction": "",
    "numerics.continuum.dim": "2",
    "numerics.continuum.order": "",
    "numerics.continuum.elements_per_block": "2",
    "numerics.continuum.scheme": "",
}

HEAD = """\
A scene of jointwave: what is there, what acts on it, how long, and what is recorded.
SI units. y runs along the pillar from the loaded end, x and z across; compression is positive.
A line such as "# cycles = 2" is a choice: take its "# " away, and that of its table's heading.
What is left out is not computed. Numbers such as (10) are equations of Guo & Li (2002).
There are more keys: see the scene reference.
"""

TAIL = """\
[expect]  # bounds on the relative L2 misfit of pairs; `pytest {file}` holds the scene to them
"dem ~ lattice" = 5e-3                    # rigid blocks, to their exact solution
"continuum-jointed ~ jointed-bar" = 1e-2  # rock with its joints, to its own

[[variants]]  # the same scene with changes, under a name of its own; any number of them
name = "no layer"
soft_layers = []
"""


def write_new(name: str, source: str | None = None) -> list[Path]:
    """Write a scene of this name, or a copy of the scene `source` with the files that it names.

    Returns the files. Raises SceneError where one of them is there already: nothing is replaced.
    """
    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    if path.name.startswith((".", " ")) or not name.isprintable():
        raise SceneError("NAME", name, None, "must be the name of a file, not beginning with '.'")
    if source is None:
        return [create(path, starter(path).encode())]
    given = find(source)
    load(given)
    places = {path: given, **{path.parent / file: given.parent / file for file in _files(given)}}
    for place in places:
        if place.exists() or place.is_symlink():
            raise SceneError(str(place), "", None, "is there already: choose another NAME")
    return [create(place, original.read_bytes()) for place, original in places.items()]


def _files(scene: Path) -> list[str]:
    """Return the files that a scene and its variants name."""
    from cases.size import value_of

    found = [value_of(one, key) for one in cases.load(scene) for key in FILE_KEYS]
    return [str(file) for file in dict.fromkeys(found) if file is not None]


def starter(path: Path) -> str:
    """Return a scene that runs as it stands, to be written at a path."""
    shown, folder = quote(path.name), quote(path.stem)
    begin = [
        f"Look:  jointwave explain {shown}",
        f"Run:   jointwave compare {shown} --out {folder}",
    ]
    title = _key("title", json.dumps(path.stem), *_about(TableOf("", Scene, False), "title"))
    parts = [*(f"# {line}".rstrip() for line in [*HEAD.splitlines(), *begin]), "", title, ""]
    for table in tables():
        if any(key.rpartition(".")[0] == table.path for key in (*SET, *OFFERED)):
            parts += [*_table(table), ""]
    return "\n".join([*parts, TAIL.format(file=shown)])


def _table(table: TableOf) -> Iterator[str]:
    yield from (f"# {line}" for line in wrap(inspect.getdoc(table.model) or "", WIDTH - 2))
    names = [name for name, field in table.fields if not model_in(field.annotation)]
    wanted = [name for name in names if table.dotted(name) in {**SET, **OFFERED}]
    holds = any(table.dotted(name) in SET for name in wanted)
    yield table.heading if holds else f"# {table.heading}"
    for name in wanted:
        key = table.dotted(name)
        value = SET.get(key) or OFFERED[key] or json.dumps(default_of(dict(table.fields)[name]))
        yield _key(name, value, *_about(table, name), chosen=key in SET)


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

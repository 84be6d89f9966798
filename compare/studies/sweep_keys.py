"""The points of sweeps and ensembles: a scene at every value of some keys.

Values are given as `--sweep KEY=FROM:TO:COUNT`, `KEY=log:FROM:TO:COUNT` or `KEY=A,B,C`. Member n of
an ensemble adds n - 1 to the seed of random joints; in a rock mass n - 1 times the number of seeds
from the least to the largest of its sets, so that no member repeats a set of another.
"""

import json
import re
from itertools import product
from math import isfinite, prod
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.read import parse_override
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.scenes import find, load, load_variants

MEMBER = "member"  # the key of an ensemble
MOST = 10_000  # points
LONGEST = 100  # characters of a folder's name
FORMS = "must be KEY=FROM:TO:COUNT, KEY=log:FROM:TO:COUNT or KEY=A,B,C"


class Case(NamedTuple):
    """A variant of a scene with its swept keys set.

    folder : for its files, with a subfolder per variant; None writes nothing. scene : None if it is
    invalid; `message` says why.
    """

    settings: dict[str, Any]
    folder: Path | None
    scene: "AnyScene | None"
    message: str = ""

    @property
    def point(self) -> str:
        """The keys with their values."""
        return ", ".join(f"{key}={value}" for key, value in self.settings.items())

    @property
    def columns(self) -> dict[str, Any]:
        """Its values, variant and folder, as columns of a table."""
        variant = self.scene.name if self.scene else ""
        folder = str(self.folder / variant) if self.folder else ""
        return {
            key: json.dumps(value, default=str) if isinstance(value, list | dict) else value
            for key, value in self.settings.items()
        } | {"variant": variant, "folder": folder}


def cases_of(
    scene: str,
    changes: list[str],
    variant: str | None,
    given: list[str],
    out: Path | None,
    members: int = 0,
) -> list[Case]:
    """Return the cases of `--set`, `--variant`, `--sweep` and `--ensemble`: each variant at each
    point. Raises SceneError in one line, also if no point has a valid scene."""
    fixed = dict(map(parse_override, changes))
    values = axes(given, list(fixed)) | ({MEMBER: [*range(1, members + 1)]} if members else {})
    path, found, errors = find(scene), [], []
    for i, combination in enumerate(product(*values.values()), start=1):
        setting = dict(zip(values, combination, strict=True))
        folder = None if out is None else out / _folder(setting, i)
        try:
            keys = {**fixed, **setting}
            number = keys.pop(MEMBER) if members else 0
            scenes = _scenes(path, variant, keys, number)
        except SceneError as error:
            errors.append(error)
            found.append(Case(setting, folder, None, str(error)))
        else:
            found += [Case(setting, folder, one) for one in scenes]
    if errors and len(errors) == len(found):
        raise errors[0]
    return found


def _scenes(
    path: Path, variant: str | None, changes: dict[str, Any], number: int
) -> list[AnyScene]:
    """Return the variants of a scene, or member `number` (from 1) of their ensembles; 0: none."""
    found = load_variants(path, changes) if variant is None else [load(path, variant, changes)]
    if not number:
        return found
    seeds = [_seeds(one, number) for one in found]
    if not any(seeds):
        allowed = "needs random joints: [scatter] or joint_sets.*.scatter, with a seed"
        raise SceneError(found[0].where, "--ensemble", None, allowed)
    return [load(path, one.name, changes | own) for one, own in zip(found, seeds, strict=True)]


def _folder(setting: dict[str, Any], number: int) -> str:
    """Return the name of a point's folder: its values, or its number if they make no valid name."""
    name = ",".join(f"{k}={_plain(v)}" for k, v in setting.items())
    plain = name.isprintable() and not set(name) & set("/\\[{") and len(name.encode()) <= LONGEST
    return name if plain else f"point-{number:05d}"


def _plain(value: Any) -> Any:
    """Return a value with whole numbers as such: 0 and 0.0 are one point."""
    whole = isinstance(value, float) and value.is_integer() and abs(value) < 1e15
    return int(value) if whole else value


def _seeds(scene: AnyScene, number: int) -> dict[str, int]:
    """Return the seeds of a scene's member `number` (from 1) by key; none without random joints."""
    scatter = getattr(scene, "scatter", None)
    found = {} if scatter is None else {"scatter.seed": scatter.seed}
    for i, one in enumerate(scene.joint_sets):
        if one.seed is not None:
            found[f"joint_sets.{i}.seed"] = one.seed
    span = 1 + max(found.values(), default=0) - min(found.values(), default=0)
    return {key: seed + (number - 1) * span for key, seed in found.items()}


def axes(given: list[str], fixed: list[str]) -> dict[str, list[Any]]:
    """Return the values of every key of `--sweep`; raises SceneError, in one line.

    fixed : keys of `--set`, which cannot be swept.
    """
    found: dict[str, list[Any]] = {}
    for text in given:
        key, _, spec = (part.strip() for part in text.partition("="))
        if not (key and spec):
            raise SceneError("--sweep", text, None, f"{FORMS}, e.g. joints.damping_ratio=0.01,0.1")
        if key in found or key in fixed:
            raise SceneError("--sweep", text, None, f"{key} is given already")
        between = re.match(r"""[^"'\[{]*:""", spec)
        found[key] = _between(text, spec) if between else _listed(text, spec)
    if (count := prod(map(len, found.values()))) > MOST:
        raise SceneError("--sweep", "", None, f"gives {count:,} points; at most {MOST:,}")
    return found


def _listed(text: str, spec: str) -> list[Any]:
    values = parse_override(f"value=[{spec}]")[1]
    if isinstance(values, str):  # words without quotes
        values = [parse_override(f"value={part.strip()}")[1] for part in spec.split(",")]
    if len({json.dumps(_plain(value), default=str) for value in values}) < len(values):
        raise SceneError("--sweep", text, None, "must not repeat a value")
    return values


def _between(text: str, spec: str) -> list[Any]:
    """Return values from one end to the other, rounded to 12 digits: 0.3, not 0.30000000000004."""
    try:
        first, last, count = spec.removeprefix("log:").split(":")
        begin, end, n = float(first), float(last), int(count)
    except ValueError:
        raise SceneError("--sweep", text, None, f"{FORMS}, of numbers") from None
    if not (isfinite(begin) and isfinite(end) and begin != end and 2 <= n <= MOST):
        allowed = f"must have two finite ends that differ, and a COUNT of 2 to {MOST:,}"
        raise SceneError("--sweep", text, None, allowed)
    log = spec.startswith("log:")
    if log and not begin * end > 0:
        raise SceneError("--sweep", text, None, "with log: must have ends of one sign, not zero")
    inner = (np.geomspace if log else np.linspace)(begin, end, n)[1:-1]
    values = [begin, *(float(f"{value:.12g}") for value in inner), end]
    whole = all(re.fullmatch(r"\s*[+-]?\d+\s*", part) for part in (first, last))
    return [int(v) for v in values] if whole and all(v == int(v) for v in values) else values

"""Studies: a scene, curves of varied keys, and the references of errors, read from TOML."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import prod
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from jointwave import cases
from jointwave.cases.errors import SceneError, nearest
from jointwave.cases.files import read_toml
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import names
from jointwave.compare.scenes import find

SHIPPED = Path(__file__).parent / "shipped"
IN_CODE = ("stability", "oblique-joint", "parallel-joints")  # studies without a file
LARGEST_FILE = 1_000_000  # bytes
MOST_POINTS = 10_000
FINEST, NONE = "finest", "none"  # references that are not names of solvers


def _is_known(name: Any) -> Any:
    known = (*names(), FINEST, NONE)
    if isinstance(name, str) and name not in known:
        raise ValueError(f"must be one of {', '.join(known)}")
    return name


KNOWN = BeforeValidator(_is_known)


def combinations(values: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Return every combination of the values of some keys; the last key varies fastest."""
    return [dict(zip(values, one, strict=True)) for one in product(*values.values())]


Changes = dict[str, Any]
Varied = dict[str, Annotated[list[Any], Field(min_length=1)]]


class StudyTable(BaseModel):
    """A table of a study's file; unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class FineRun(StudyTable):
    """The reference of errors if there is no exact solution: an engine's fine run.

    changes : of the scene, mainly its numerics. coarser : additional changes for a coarser run; the
        distance between both is the floor below which errors are not known.
    """

    method: Annotated[str, KNOWN]
    changes: Changes = {}
    coarser: Changes


class Curve(StudyTable):
    """One way to solve the scene, with its varied keys.

    method : an engine or an exact solution.
    vary : dotted keys and their values: every combination is a point.
    each : dotted keys and their values: every combination is a separate curve. In its label the
        value replaces the last part of the key in braces.
    own : reference of the numerical error: the exact solution of the curve's own model, or a fine
        run of it; "finest": the reference of the study; "none"; absent: the highest-ranking exact
        solution (`compare.misfit.ranking`), else the curve's method with the numerics of the
        study's fine run.
    order : theoretical order of the numerical error in the first varied key, or in its inverse if
        the error falls as the key grows (elements, steps per period).
    """

    label: str
    method: Annotated[str, KNOWN]
    changes: Changes = {}
    vary: Varied = {}
    each: Varied = {}
    own: Annotated[str | FineRun | None, KNOWN] = None
    order: float | None = None


def _expanded(curves: list[Curve]) -> list[Curve]:
    """Return the curves with `each` expanded; raises ValueError for more points than allowed."""
    lengths = ([*map(len, (*one.each.values(), *one.vary.values()))] for one in curves)
    if (count := sum(map(prod, lengths))) > MOST_POINTS:
        raise ValueError(f"give {count:.6g} points, at most {MOST_POINTS}")
    found = []
    for one, values in ((curve, x) for curve in curves for x in combinations(curve.each)):
        label = one.label
        for key, value in values.items():
            label = label.replace(f"{{{key.rpartition('.')[2]}}}", str(value))
        update = {"label": label, "changes": one.changes | values, "each": {}}
        found.append(one.model_copy(update=update))
    return found


class Study(StudyTable):
    """A scene, its finest physics, and curves.

    finest : the reference of modelling errors: an exact solution or a fine run; "none";
        absent: the exact solution that ranks highest.
    quantity : the misfit is its relative L2 norm over time and all receivers, as in the theory of
        orders; absent: the misfit of the worst waveform.
    note : a remark for the reader.
    timed : whether seconds are compared: points are then run one at a time, `repeats` times each.
    """

    title: str
    scene: str
    variant: str = ""
    changes: Changes = {}
    finest: Annotated[str | FineRun | None, KNOWN] = None
    quantity: Literal["stress", "velocity", "displacement"] | None = None
    note: str = ""
    timed: bool = False
    repeats: Annotated[int, Field(ge=1, le=100)] = 3
    curves: Annotated[list[Curve], Field(min_length=1), AfterValidator(_expanded)]

    def changed(self, changes: dict[str, Any]) -> AnyScene:
        """Return the scene with further changes; raises SceneError if it is invalid."""
        changes = self.changes | changes | {"expect": {}}
        return cases.load_variant(find(self.scene), self.variant, changes, asked=False)

    @cached_property
    def base(self) -> AnyScene:
        """The scene itself; raises SceneError if it is invalid."""
        return self.changed({})

    def points(self) -> list["StudyPoint"]:
        """Return all points, curve by curve."""
        return [
            StudyPoint(self, curve, settings)
            for curve in self.curves
            for settings in combinations(curve.vary)
        ]


@dataclass(frozen=True)
class StudyPoint:
    """One run of a study: a curve with one value of each varied key."""

    study: Study
    curve: Curve
    settings: dict[str, Any]

    @property
    def changes(self) -> dict[str, Any]:
        """The changes of the scene."""
        return self.curve.changes | self.settings

    @property
    def physics(self) -> dict[str, Any]:
        """The changes of the scene besides its numerics."""
        return {k: v for k, v in self.changes.items() if not k.startswith("numerics.")}

    @cached_property
    def scene(self) -> AnyScene:
        """The scene to solve; raises SceneError if it is invalid."""
        return self.study.changed(self.changes)


def shipped() -> dict[str, Path]:
    """Return the shipped studies by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def load(name: str) -> Study:
    """Read a shipped study, or a file, which may give its scene relative to itself.

    Raises SceneError, in one line.
    """
    path = shipped().get(name, Path(name))
    if not path.is_file():
        known = [*shipped(), *IN_CODE]
        allowed = f"is not a file, nor one of {', '.join(known)}{nearest(name, known)}"
        raise SceneError(name, "", None, allowed)
    try:
        table = read_toml(path, LARGEST_FILE)
        json.dumps(table)  # raises TypeError for values that cannot be saved
        study = Study.model_validate(table)
    except ValidationError as error:
        first = error.errors()[0]
        key, value = ".".join(map(str, first["loc"])), first["input"]
        given = value if isinstance(value, str | int | float) else None
        allowed = first["msg"].removeprefix("Value error, ")
        raise SceneError(str(path), key, given, allowed[0].lower() + allowed[1:]) from None
    except ValueError as error:
        raise SceneError(str(path), "", None, str(error)) from None
    except TypeError:
        raise SceneError(str(path), "", None, "dates are no values of a study") from None
    beside = path.parent / study.scene
    return study.model_copy(update={"scene": str(beside)}) if beside.is_file() else study

"""Studies: a scene, curves of varied keys, and the references of errors."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import prod
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

import cases
from cases.errors import SceneError, nearest
from cases.files import read_toml
from cases.kinds import AnyScene
from compare.experiments import IN_CODE
from compare.experiments.common import combinations
from compare.experiments.study.check import ARGUMENTS, MOST_POINTS, plain, refuse_senseless
from compare.scenes import find

LARGEST_FILE = 1_000_000  # bytes
SHIPPED = Path(__file__).parent / "shipped"
FINEST, NONE = "finest", "none"  # references of errors other than solutions


Value = Annotated[Any, AfterValidator(plain)]
Values = Annotated[list[Value], Field(min_length=1)]


class StudyTable(BaseModel):
    """A table of a study's file; unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class FineRun(StudyTable):
    """The reference of errors if there is no exact solution: an engine's fine run.

    changes : of the scene, mainly its numerics. coarser : additional changes; the distance of that
        run from this one is the floor below which errors are not known.
    """

    method: str
    changes: dict[str, Value] = Field(default_factory=dict)
    coarser: dict[str, Value]


class Curve(StudyTable):
    """One way to solve the scene, with its varied keys.

    method : an engine, an exact solution, or a method of
    `compare.experiments.study.methods`.
    vary : dotted keys and their values, all combinations; `terms` is an exact series' own.
    each : dotted keys and their values: every combination is a curve of its own, whose label has
        the value in place of the key's last part in braces.
    own : the exact solution of the curve's own model, or a fine run of it, for its numerical
        error; "finest": that of the study; "none"; absent: the exact one that ranks highest
        (`compare.misfit.ranking`), else a run of its engine at the numerics of the study's fine
        run.
    order : in theory, of the numerical error, with the first varied key or, where that falls as
        its value grows (elements, steps per period), with its inverse.
    """

    label: str
    method: str
    changes: dict[str, Value] = Field(default_factory=dict)
    vary: dict[str, Values] = Field(default_factory=dict)
    each: dict[str, Values] = Field(default_factory=dict)
    own: str | FineRun | None = None
    order: float | None = None

    def expanded(self) -> Iterator["Curve"]:
        """Yield the curves into which `each` expands this one."""
        for values in combinations(self.each):
            label = self.label
            for key, value in values.items():
                label = label.replace(f"{{{key.rpartition('.')[2]}}}", str(value))
            changes = self.changes | values
            yield self.model_copy(update={"label": label, "changes": changes, "each": {}})


def each_expanded(curves: list[Curve]) -> list[Curve]:
    """Return the curves without `each`; raises ValueError for more than a study may have."""
    count = sum(prod(map(len, curve.each.values())) for curve in curves)
    if count > MOST_POINTS:
        raise ValueError(f"give {count:.6g} curves, at most {MOST_POINTS}")
    return [one for curve in curves for one in curve.expanded()]


class Study(StudyTable):
    """A scene, its finest physics, and curves.

    finest : the reference of modelling errors: an exact solution or a fine run; "none";
        absent: the exact solution that ranks highest (`compare.misfit.ranking`).
    quantity : whose relative L2 norm over time and all its receivers is the misfit, as in
        the theory of orders; absent: the misfit of the worst waveform.
    note : a remark for the reader.
    timed : whether seconds count: points are then run one at a time, `repeats` times each.
    """

    title: str
    scene: str
    variant: str = ""
    changes: dict[str, Value] = Field(default_factory=dict)
    finest: str | FineRun | None = None
    quantity: Literal["stress", "velocity", "displacement"] | None = None
    note: str = ""
    timed: bool = False
    repeats: Annotated[int, Field(ge=1, le=100)] = 3
    curves: Annotated[list[Curve], Field(min_length=1), AfterValidator(each_expanded)]

    @property
    def base(self) -> "AnyScene":
        """The scene without the curves' changes."""
        return self.changed({})

    def changed(self, changes: dict[str, Any]) -> "AnyScene":
        """Return the scene with changes; raises SceneError if it is invalid."""
        changes = self.changes | changes | {"expect": {}}
        return cases.load_variant(find(self.scene), self.variant, changes, asked=False)

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
        """All changes, keys of the scene and arguments."""
        return self.curve.changes | self.settings

    @cached_property
    def scene(self) -> "AnyScene":
        """The scene to solve; raises SceneError if it is invalid."""
        return self.study.changed({k: v for k, v in self.changes.items() if k not in ARGUMENTS})

    @property
    def physics(self) -> dict[str, Any]:
        """The changes of the scene besides its numerics."""
        of_scene = {k: v for k, v in self.changes.items() if k not in ARGUMENTS}
        return {k: v for k, v in of_scene.items() if not k.startswith("numerics.")}

    @property
    def arguments(self) -> dict[str, Any]:
        """The settings that are not keys of the scene, such as the terms of a series."""
        return {k: v for k, v in self.changes.items() if k in ARGUMENTS}


def shipped() -> dict[str, Path]:
    """Return the shipped studies by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def load(name: str) -> Study:
    """Read a shipped study or a study's file, whose scene may be given relative to it.

    Raises SceneError, in one line.
    """
    path = shipped().get(name, Path(name))
    if not path.is_file():
        names = [*shipped(), *IN_CODE]
        known = ", ".join(names) + nearest(name, names)
        raise SceneError(name, "", None, f"is not a file, nor one of {known}")
    try:
        table = read_toml(path, LARGEST_FILE)
    except ValueError as error:
        raise SceneError(str(path), "", None, str(error)) from None
    try:
        study = Study.model_validate(table)
    except ValidationError as error:
        raise _study_error(path, error) from None
    refuse_senseless(path, study)
    beside = path.parent / study.scene
    if beside.is_file():
        study = study.model_copy(update={"scene": str(beside)})
    return study


def _study_error(path: Path, error: ValidationError) -> SceneError:
    first = error.errors()[0]
    key = ".".join(str(part) for part in first["loc"])
    value = None if isinstance(first["input"], dict) else first["input"]
    return SceneError(str(path), key, value, first["msg"].lower())

"""The tests of a scene file: the misfit of each pair in [expect] against its bound."""

import shlex
from collections.abc import Iterator
from math import isnan
from pathlib import Path
from typing import Any
from warnings import warn

import pytest

from jointwave.cases.errors import SceneError, UnstableError
from jointwave.compare.cli import SceneWarning
from jointwave.compare.cli.inputs import scene_warnings
from jointwave.compare.engines import applies, solve
from jointwave.compare.misfit.differences import distance_of, static_difference
from jointwave.compare.scenes import bound_of, load_variants
from jointwave.results.dataset import scene_hash


class Misfit(Exception):
    """A pair whose misfit exceeds its bound, or cannot be measured."""


class SceneFile(pytest.File):
    """A scene file; its tests are the keys of [expect] in each variant to which they apply.

    results : by scene hash and solver, while the tests of this file run.
    """

    def teardown(self) -> None:
        """Release the results; all scenes together take gigabytes."""
        self.results.clear()

    def collect(self) -> Iterator["PairItem"]:
        """Yield the tests; failing ones for a file that is no scene and keys that never apply."""
        self.results: dict[tuple[str, str], Any] = {}
        try:
            scenes = load_variants(self.path)
        except SceneError as error:
            yield PairItem.from_parent(self, name="scene", reason=str(error))
            return
        reasons: dict[str, list[str]] = {}
        for scene in scenes:
            for key, most in scene.expect.items():
                answers = {name: applies(name, scene) for name in bound_of(key)[:2]}
                reason = "; ".join(f"{name}: {a.reason}" for name, a in answers.items() if not a)
                reasons.setdefault(key, []).append(reason)
                if not reason:
                    name = f"{scene.name}: {key}" if scene.name else key
                    yield PairItem.from_parent(self, name=name, scene=scene, key=key, most=most)
        for key, each in reasons.items():
            if all(each):
                reason = f"{key} does not apply to any variant: {each[0]}"
                yield PairItem.from_parent(self, name=key, reason=reason)


class PairItem(pytest.Item):
    """The test of one pair in one variant against its bound."""

    def __init__(self, *, scene=None, key="", most=0.0, reason="", **kwargs) -> None:
        super().__init__(**kwargs)
        self.scene, self.key, self.most, self.reason = scene, key, most, reason

    def runtest(self) -> None:
        """Measure the pair; raises Misfit with the reason of a failure."""
        if self.reason:
            raise Misfit(self.reason)
        for line in scene_warnings(self.scene):
            warn(SceneWarning(f"{self.scene.where}: {line}"), stacklevel=1)
        try:
            bound = bound_of(self.key)
            one, other = self._solved(bound.one), self._solved(bound.other)
        except (SceneError, UnstableError) as error:
            raise Misfit(f"{self.key}: {error}") from None
        found = distance_of(bound.of, one, other)
        self.user_properties.append(("misfit", float(found.misfit)))
        if isnan(found.misfit) and found.place is None:
            raise Misfit(f"{self.key}: no receiver of the scene records it")
        if found.place is None and static_difference(one, other).place is None:
            raise Misfit(f"{self.key}: nothing moves at the receivers in either solution")
        if not found.misfit <= self.most:
            far = f"misfit {found.misfit:.3g} of {found.where} exceeds the bound {self.most:g}"
            command = ["compare", str(self.path), "--variant", self.scene.name, "--out", "misfit"]
            raise Misfit(f"{self.key}: {far}\n{shlex.join(['jointwave', *command])}")
        if not found.judged <= self.most:
            least = f"the reference's own error is {found.floor:.2g}; it can verify ten times that"
            raise Misfit(f"{self.key}: {least}; the bound is {self.most:g}")

    def _solved(self, name: str):
        """Return a result; each engine runs once for the same scene of a file."""
        assert isinstance(self.parent, SceneFile)
        results, key = self.parent.results, (scene_hash(self.scene), name)
        if key not in results:
            results[key] = solve(name, self.scene)
        return results[key]

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style=None):
        """Return the message without a traceback."""
        if isinstance(excinfo.value, Misfit | SceneWarning):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """Return the location of the test."""
        return self.path, None, self.name

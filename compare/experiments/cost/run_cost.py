"""What a run would take, told without it: its steps, its size, its seconds, its memory."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from cases.effects import is_spatial
from cases.schema.scene import Scene
from cases.size import estimates, waveform_bytes
from compare.engines import ENGINES
from compare.experiments.cost import timings
from compare.runs.processes import started


class Forecast(NamedTuple):
    """A run that is not made.

    steps : of time, exactly; 0 of exact solutions. size : blocks or freedoms of the rock, in words.
    seconds : of stepping, at the rate last measured here; None where none was. bytes : of memory,
        as the run itself would estimate it before it begins; of exact solutions their waveforms,
        which is the least that they take.
    """

    variant: str
    engine: str
    steps: int
    size: str
    scheme: str
    seconds: float | None
    bytes: float


def forecast(scene: Scene, name: str) -> Forecast:
    """Return what a run of an engine or exact solution would take.

    Raises SceneError where it cannot be made, as the run would.
    """
    if name not in ENGINES:
        seconds = timings.stepping(name, scene, {})
        return Forecast(scene.name, name, 0, "-", "exact", seconds, waveform_bytes(scene))
    with estimates() as parts:
        about = _of_blocks(scene) if name == "dem" else _of_rock(scene, name)
    count, what = timings.units(name, scene, about), "blocks" if name == "dem" else "freedoms"
    return Forecast(
        scene.name,
        name,
        about["steps"],
        f"{count:,} {what}",
        about["scheme"],
        timings.stepping(name, scene, about),
        sum(parts.values()),
    )


def seconds_of(found: Iterable[Forecast]) -> tuple[float, int]:
    """Return the seconds of all that were ever timed here, and how many were not."""
    known = [one.seconds for one in found]
    return sum(s for s in known if s is not None), known.count(None)


def _of_blocks(scene: Scene) -> dict[str, Any]:
    about: dict[str, Any] = {"scheme": scene.numerics.dem.scheme, "threads": 1}
    if is_spatial(scene):
        from dem.spatial.simulate import prepare
        from dem.spatial.threads import thread_count

        time, count = prepare(scene).time, scene.pillar.block_count
        about["threads"] = thread_count(scene.numerics.dem.threads, count)
    else:
        from dem.axial.simulate import scheme_of

        _, _, time, _ = scheme_of(scene).build(scene)
    return {**about, "steps": time.steps}


def _of_rock(scene: Scene, name: str) -> dict[str, Any]:
    from continuum.build import critical_step_of, discretise
    from continuum.scheme import choose
    from continuum.size import refuse_large_run

    model = name.removeprefix("continuum-")
    discrete = discretise(scene, model)
    choice = choose(scene, discrete, critical_step_of(scene, discrete, model))
    refuse_large_run(scene, discrete.kinematics, choice.time)
    return {
        "processes": started().size,
        "scheme": choice.scheme,
        "dim": discrete.kinematics.dim,
        "cell": discrete.body.mesh.cell,
        "order": scene.numerics.continuum.order,
        "steps": choice.time.steps,
        "degrees_of_freedom": discrete.body.degrees_of_freedom,
    }

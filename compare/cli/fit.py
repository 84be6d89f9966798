"""`jointwave fit`: keys of a scene from measured waveforms."""

import shlex

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli.commands import Fit
from jointwave.compare.cli.forecast import show_forecasts
from jointwave.compare.cli.inputs import load, warn
from jointwave.compare.cli.terminal import print_json, progress, say, show_table
from jointwave.compare.engines import label_of
from jointwave.compare.misfit.external import doubts, read_curves
from jointwave.compare.runs import jobs
from jointwave.compare.runs.output import write_csv
from jointwave.compare.studies import fit as fits
from jointwave.compare.studies.fit_keys import unit_of


def fit(asked: Fit) -> None:
    """Fit a scene and print its values, or what the search would cost."""
    (scene,) = load(asked, every=False)
    curves = read_curves(asked.given, [scene])
    warn([scene], asked.strict, lambda one: doubts(curves, one))
    solver = _solver(asked, scene)
    if asked.dry:
        show_forecasts([fits.planned(scene, asked.free, solver)], asked.as_json)
        return
    with progress(scene.name or scene.title) as advance:
        found = fits.fit(scene, curves, asked.free, solver, advance)
    files = []
    if asked.out is not None:
        files = [write_csv(asked.out / "fit.csv", found.table.reset_index(), 12)]
    values, waveforms = found.values.reset_index(), found.waveforms.astype({"place": str})
    values.insert(1, "unit", [unit_of(key, scene) for key in values.key])
    if asked.as_json:
        facts = {
            "title": scene.title,
            "variant": scene.name,
            "solver": found.solver,
            "keys": values.to_dict("records"),
            "correlation": found.correlation.values.tolist(),
            "waveforms": waveforms.to_dict("records"),
            "trials": found.trials,
            "notes": found.notes,
            "set": found.settings,
            "files": list(map(str, files)),
        }
        print_json(facts)
        return
    title = f"{scene.title} {scene.name}".strip()
    say(f"{title}, fitted by {label_of(found.solver)} ({found.trials} solutions)", "bold")
    worst = waveforms.loc[waveforms.after.idxmax()]
    where = f"; worst {worst['name']}, {worst.place}" if len(waveforms) > 1 else ""
    say(f"misfit {waveforms.before.max():.3%} before, {worst.after:.3%} after{where}")
    say("values, with 95 % intervals", "bold")
    cells = values[["key", "unit", "value", "low", "high", "start"]]
    show_table(
        [*cells], cells.map(lambda x: x if isinstance(x, str) else f"{x:.6g}").values.tolist()
    )
    for note in found.notes:
        say(f"note: {note}")
    say("The intervals assume the model: jointwave compare shows how far models differ.")
    options = [("--set", x) for x in [*asked.changes, *found.settings]]
    options += [("--with", file) for file in asked.given]
    command = ["jointwave", "compare", asked.scene, "--variant", scene.name, *sum(options, ())]
    say(f"compare: {shlex.join(command + ['--align'] * ('clock' in found.values.index))}")


def _solver(asked: Fit, scene: AnyScene) -> str | None:
    """Return the solution selected by --engine and --model; None without them."""
    models = asked.model or []
    if asked.engine is None and not models:
        return None
    of = asked.engine.value if asked.engine else jobs.engine_of(models[0])
    found = [name for run in jobs.wanted([of], models) for name in jobs.names_of(*run, scene)]
    if len(found) > 1:
        raise SceneError("--model", "", None, f"must be one of {', '.join(found)}")
    return found[0]

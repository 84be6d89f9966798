"""The pytest plugin, run on scene files as a user's own tests would be."""

import re
import sys
from importlib import import_module

import pytest

pytest_plugins = ["pytester"]

MEASURES = "jointwave.compare.cli.scene_tests"  # the module that solves scenes

SCENE = """\
title = "ten blocks"
[pillar]
length = 5.0
side = 0.5
block = 0.5
[rock]
density = 2400.0
p_speed = 2200.0
s_speed = 800.0
[load]
shape = "sine"
amplitude = 1.0e6
period = 0.01
[time]
duration = 0.01
[record]
stress = [2.0]
[expect]
"{pair}" = {bound}
"""

VARIANT = """
[[variants]]
name = "no tension"
joints.tension = false
"""


@pytest.fixture(scope="module")
def warm(tmp_path_factory):
    """Import what the engines need: pytester forgets after each run what was imported in it."""
    import_module(MEASURES)
    from jointwave.cases import load
    from jointwave.compare.engines import solve
    from jointwave.compare.misfit.metrics import misfit

    path = tmp_path_factory.mktemp("warm") / "scene.toml"
    path.write_text(scene() + VARIANT)
    bonded, barred = load(path)
    assert misfit(solve("dem", bonded), solve("lattice", bonded)) < 0.01
    assert misfit(solve("dem", barred), solve("no-tension-chain", barred)) < 0.01


@pytest.fixture
def run(warm, pytester):
    """A function that writes TOML files and runs pytest on their folder."""

    def run(*options, **files):
        for name, text in files.items():
            (pytester.path / f"{name}.toml").write_text(text, encoding="utf-8")
        return pytester.runpytest_inprocess("-p", "no:cacheprovider", *options)

    return run


def scene(pair="dem ~ lattice", bound=1.0):
    """Return a scene file that expects one bound."""
    return SCENE.format(pair=pair, bound=bound)


def test_bound_that_is_met_and_its_misfit_is_kept_with_the_results(run, pytester):
    """The documentation's table of verification reads it there."""
    result = run("-v", "--junitxml", "tests.xml", scene=scene(bound=0.01))
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(["scene.toml::dem ~ lattice PASSED*"])
    found = (pytester.path / "tests.xml").read_text(encoding="utf-8")
    assert 'classname="scene.toml" name="dem ~ lattice"' in found
    assert 0 < float(re.search(r'name="misfit" value="([^"]+)"', found)[1]) <= 0.01


def test_bound_that_is_not_met_prints_pair_misfit_bound_and_command_alone(run, pytester):
    result = run(scene=scene(bound=1e-9))
    result.assert_outcomes(failed=1)
    first = next(i for i, line in enumerate(result.outlines) if line.startswith("dem ~ lattice"))
    before, said, command, after = result.outlines[first - 1 : first + 3]
    exceeds = r"dem ~ lattice: misfit \S+ of stress at 2 m exceeds the bound 1e-09"
    assert before.strip("_ ") == "dem ~ lattice" and re.match(exceeds, said)
    file = pytester.path / "scene.toml"
    assert command == f"jointwave compare {file} --variant '' --out misfit"
    assert after.startswith("===")


@pytest.mark.parametrize(
    ("of", "bound", "says"),
    [
        ("stress", 0.01, None),
        ("PPV", 0.01, None),
        ("velocity", 1e-9, "misfit * of velocity at 2.25 m exceeds the bound 1e-09"),
        ("peak stress", 1e-9, "misfit * of peak stress at 2 m exceeds the bound 1e-09"),
        ("rotation", 1.0, "no receiver of the scene records it"),
        ("speed", 1.0, "must end in ': ' and one of *velocity*PPV, peak stress"),
    ],
)
def test_a_bound_of_one_quantity_or_peak(run, of, bound, says):
    text = scene(f"dem ~ lattice: {of}", bound)
    result = run(scene=text.replace("stress = [2.0]", "stress = [2.0]\nvelocity = [2.25]"))
    result.assert_outcomes(passed=says is None, failed=says is not None)
    if says:
        result.stdout.fnmatch_lines([f"*dem ~ lattice: {of}*: {says}*"])


def test_no_bound_is_met_at_rest(run):
    """A block that the load pulls off a pillar without tension leaves nothing to compare."""
    text = scene("dem ~ no-tension-chain").replace("amplitude = 1.0e6", "amplitude = -1.0e6")
    result = run(scene=text.replace("[load]", "[joints]\ntension = false\n[load]"))
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["* ~ *: nothing moves at the receivers in either solution"])


def test_a_scene_is_warned_of_and_refused_where_warnings_are_errors(run):
    """As `--strict` does; a scene that says what it means is neither."""
    late = scene().replace("period = 0.01", "period = 0.011")
    result = run("-v", scene=late)
    result.assert_outcomes(passed=1, warnings=1)
    line = r"SceneWarning:\s+\S*scene\.toml: load\.period = 0\.011 s is longer"
    assert re.search(line, result.stdout.str())  # pytest 8 breaks it
    strict = "-W", "error::jointwave.pytest_plugin.SceneWarning"
    result = run(*strict, scene=late)
    result.assert_outcomes(failed=1)
    result.stdout.re_match_lines([r"\S+scene.toml: load.period = 0.011 s is longer"])
    run(*strict, scene=scene()).assert_outcomes(passed=1)


@pytest.fixture
def solved(run, monkeypatch):
    """Solve by other engines than are asked for, and return the names of those that were."""
    module, names = sys.modules[MEASURES], []
    solve = module.solve

    def instead(factors, own):
        def other(name, scene):
            names.append(name)
            return solve(own or name, scene) * factors.get(name, 1.0)

        monkeypatch.setattr(module, "solve", other)
        return names

    return instead


def test_bounds_of_inline_variants_and_of_quoted_tables_are_held_too(run):
    text, bounds = scene(bound=1e-9).split("[expect]")
    variants = 'variants = [\n{ name = "a", "expect" = { "dem ~ lattice" = 1e-9 } }]\n'
    quoted = text.replace("[pillar]", '["pillar"]') + f"[ 'expect' ]{bounds}"
    run(inline=variants + text, quoted=quoted).assert_outcomes(failed=2)


def test_each_variant_is_held_to_the_pairs_that_apply_and_each_engine_runs_once(run, solved):
    names = solved({}, None)
    result = run("-v", scene=scene() + '"dem ~ no-tension-chain" = 1.0\n' + VARIANT)
    result.assert_outcomes(passed=2)
    result.stdout.fnmatch_lines_random(
        ["*::dem ~ lattice PASSED*", "*::no tension: dem ~ no-tension-chain PASSED*"]
    )
    run(scene=scene() + '"dem ~ equivalent-bar" = 1.0\n').assert_outcomes(passed=2)
    assert sorted(names[:4]) == ["dem", "dem", "lattice", "no-tension-chain"]
    assert sorted(names[4:]) == ["dem", "equivalent-bar", "lattice"]


def test_scene_that_leaves_its_axis_is_held_by_its_shear(run, solved):
    """Without any normal stress, a shear that is 1 % off is 1 % of misfit."""
    solved({"dem": 1.01}, "spatial-lattice")
    sheared = scene("dem ~ spatial-lattice", 0.02).replace(
        "period = 0.01", "period = 0.01\ndirection = [1.0, 0.0, 0.0]"
    )
    run(scene=sheared).assert_outcomes(passed=1)
    run(scene=sheared.replace("0.02", "0.005")).assert_outcomes(failed=1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("block = 0.5", "block = 0.3", "*scene.toml: pillar.block = 0.3: must divide*"),
        ("block = 0.5", "block = ", "*scene.toml: is not valid TOML*"),
        (
            "[time]",
            "[numerics]\ndem.step_fraction = 2.0\n[time]",
            "dem ~ lattice: *step_fraction = 2.0*critical step*",
        ),
        ("lattice", "no-tension-chain", "*-chain does not apply to any variant: *tension*"),
    ],
)
def test_broken_scene_fails_in_one_line(run, old, new, message):
    result = run(scene=scene().replace(old, new))
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines([message])
    result.stdout.no_fnmatch_line("*Error*")
    result.stdout.no_fnmatch_line("*Traceback*")


def test_other_toml_files_are_left_alone(run):
    result = run(
        pyproject='[project]\nname = "someone-elses"\n',
        broken="[pillar\n",
        unexpecting=scene().split("[expect]")[0],
        expecting="[expect]\nanswer = 42\n",
        listed="pillar = [1, 2]\nvariants = [1]\n",
        words='names = [\n"domain",\n"expect"]\n',
    )
    result.assert_outcomes()


def test_a_run_without_scenes_imports_nothing_heavy(pytester):
    pytester.makepyfile(
        """
        import sys

        def test_nothing_heavy_is_there():
            assert "jointwave.pytest_plugin" in sys.modules
            heavy = {"numpy", "numba", "xarray", "pydantic", "dolfinx", "matplotlib", "cases"}
            assert not heavy & set(sys.modules)
        """
    )
    (pytester.path / "pyproject.toml").write_text("[project]\nname = 'x'\n")
    done = pytester.runpytest_subprocess("-p", "no:hypothesispytest", "-q")
    done.assert_outcomes(passed=1)


def test_a_rock_mass_is_held_to_its_bounds(run, one_joint, in_toml):
    """One pair is near enough, one is not, and one applies to no variant: each says so."""
    scene = one_joint(
        domain={"size": [8.0, 8.0]},
        time={"duration": 0.015},
        numerics={"continuum": {"size": 0.8}},
        record={"points": [[4.0, 2.0]], "interval": 1e-4},
        expect={
            "continuum-jointed ~ oblique-joint": 0.1,
            "oblique-joint ~ continuum-jointed": 1e-9,
            "dem ~ oblique-joint": 0.1,
        },
    )
    scene["joint_sets"][0] |= {"dip": 20.0, "through": [4.0, 4.0]}
    result = run(scene=in_toml(scene))
    result.assert_outcomes(passed=1, failed=2)
    result.stdout.re_match_lines_random(
        [
            r"oblique-joint ~ continuum-jointed: misfit \S+ of [a-z]+ [xy]+ at \[4, 2\] m exceeds",
            r"dem ~ oblique-joint does not apply to any variant: dem: numerics.dem",
        ]
    )

"""Names of the variants of a scene."""

from typing import Any

from jointwave.compare.misfit.pairs import Comparison


def variant_names(comparisons: list[Comparison]) -> list[str]:
    """Return the variants' names; the base scene is named by what its variants change, where that
    has words; alone it is the "base scene"."""
    base, *variants = (comparison.scene for comparison in comparisons)
    changed: list[str] = []
    if base.is_column:
        words, others = _words(base), [_words(variant) for variant in variants]
        changed = [word for key, word in words.items() if any(one[key] != word for one in others)]
    first = base.name or ", ".join(changed) or "base scene"
    return [name.replace("zeta ", "ζ = ") for name in (first, *(one.name for one in variants))]


def named(comparisons: list[Comparison]) -> list[tuple[str, Comparison]]:
    """Return the comparisons, each with the name of its variant."""
    return list(zip(variant_names(comparisons), comparisons, strict=True))


def _words(scene: Any) -> dict[str, str]:
    """Return what variants of pillars usually change, in words."""
    ratio = scene.joints.damping_ratio
    return {
        "damping": "undamped" if ratio is None else f"ζ = {ratio:g}",
        "start": f"{scene.ends.start} start",
        "end": scene.ends.end,
        "layers": "soft layer" if scene.soft_layers else "no soft layer",
        "tension": "no tension" if scene.joints.tension is False else "tension",
    }

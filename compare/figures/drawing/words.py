"""Joint laws in words, as captions of drawings have them."""

from cases.schema.joint import JointLaw


def law_words(law: JointLaw) -> str:
    """Return what joints can do beside being elastic; nothing where that is all."""
    parts = [
        f"damping ratio {law.damping_ratio:g}" if law.damping_ratio else "",
        "no tension" if law.tension is False else "",
        f"closure at most {1e3 * law.maximum_closure:g} mm" if law.maximum_closure else "",
        f"friction {law.friction_angle:g}°" if law.friction_angle is not None else "",
        f"dynamic friction {law.dynamic_friction_angle:g}°" if law.weakening_distance else "",
        f"dilation {law.dilation_angle:g}°" if law.dilation_angle else "",
        f"rate and state, a = {law.direct_effect:g}, b = {law.evolution_effect:g}"
        if law.direct_effect
        else "",
        f"tensile strength {law.tensile_strength / 1e6:g} MPa" if law.tensile_strength else "",
    ]
    return ", ".join(part for part in parts if part)

"""The energy that a joint stores and dissipates, per unit area (J/m2)."""

from jointwave.joints.closure import closure_energy
from jointwave.joints.formula import formula
from jointwave.joints.normal import spring_traction


@formula
def elastic_energy(law, parts, gap, opening, ex, ez):
    """Return the energy in the springs; gap, largest opening, and elastic slip ex, ez in m."""
    t = spring_traction(law, parts, gap, opening)
    energy = -0.5 * t * gap
    if parts.closure and gap < 0.0:
        energy = closure_energy(law, t)
    if parts.shear:
        energy = energy + 0.5 * law.shear_stiffness * (ex * ex + ez * ez)
    return energy


@formula
def friction_work(law, ex_old, ez_old, ex, ez, dx, dz):
    """Return the work of friction in a step of slip dx, dz: the mean spring traction times sliding.

    Sliding is slip less the change of elastic slip. The sum of this and of the change of
    `elastic_energy` is exactly the trapezoid rule of leapfrog's ledger.
    """
    along_x = (ex_old + ex) * (dx - (ex - ex_old))
    along_z = (ez_old + ez) * (dz - (ez - ez_old))
    return 0.5 * law.shear_stiffness * (along_x + along_z)


@formula
def lift_work(law, parts, gap_old, gap, opening, up):
    """Return the work of dilation in a step that goes into the springs and the rock: the mean
    traction of the normal spring times the lift `up` (m).

    gap_old, gap : less the dilation, before and after the step, m. opening : the largest so far, m.
    """
    old = spring_traction(law, parts, gap_old, opening)
    return 0.5 * (old + spring_traction(law, parts, gap, opening)) * up


@formula
def fracture_energy_spent(law, opening):
    """Return the fracture energy spent: the area under the softening curve less elastic energy.

    For the linear curve this is G_c (k - w_0) / (w_c - w_0), between zero and G_c = s_t w_c / 2.
    """
    first = law.tensile_strength / law.normal_stiffness
    whole = 0.5 * law.tensile_strength * law.critical_opening
    share = (opening - first) / (law.critical_opening - first)
    share = 1.0 if share > 1.0 else share
    return 0.0 if opening <= first else whole * share

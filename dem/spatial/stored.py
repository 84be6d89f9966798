"""What a tile holds at a sample: in its joints, spent by their opening, and in gravity."""

from dem.spatial.book import (
    ELASTIC,
    FRACTURE,
    GRAVITY,
)
from dem.spatial.contact import law_at
from dem.spatial.finite import (
    area_in_contact,
    finite_gap_at,
    finite_relative,
    finite_slip_at,
)
from dem.spatial.kinematics import gap_at, relative, shift, slip_at, turn
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.layout import first_opening, first_slide
from dem.spatial.points import whole_area
from joints.energy import elastic_energy, fracture_energy_spent
from numerics.jit import inlined
from numerics.optional import either, given


@inlined
def book_states(model, book, table, s, h, n, final):
    """Book what a tile holds at a sample: in its joints and in gravity."""
    if book is not None:
        contact = model.contact
        joints = n - 1 if final else n
        book_section(contact, contact.section, table, book, s, joints)
        book_points(contact, contact.points, table, book, s, h, joints)
        book_weight(model.weight, book, s, n)


@inlined
def book_section(contact, section, table, book, s, n):
    """Book the energy of the first n joints, where they always hold."""
    if section is not None:
        arm = contact.arm
        for i in range(min(n, L)):
            law = law_at(contact.law, table, i)
            g, phi = shift(s, 0, i, arm), turn(s, 0, i, arm)
            k_n, k_s = 0.5 * law.normal_stiffness, 0.5 * law.shear_stiffness
            held = k_n * g[1] * g[1] + k_s * (g[0] * g[0] + g[2] * g[2])
            bent = k_n * (phi[0] * phi[0] + phi[2] * phi[2])
            twisted = k_s * phi[1] * phi[1]
            book[ELASTIC * R + i] += (
                section.area * held + section.across * bent + section.along * twisted
            )


@inlined
def book_points(contact, points, table, book, s, h, n):
    """Book what the first n joints hold and what they have spent, at every contact point."""
    if points is not None:
        arm, rows = contact.arm, contact.rows
        slides, openings = first_slide(rows), first_opening(rows)
        gap_of = either(contact.finite, gap_at, finite_gap_at)
        slip_of = either(contact.finite, slip_at, finite_slip_at)
        area_of = either(contact.finite, whole_area, area_in_contact)
        for i in range(min(n, L)):
            law = law_at(contact.law, table, i)
            motion = either(contact.finite, relative, finite_relative)(contact, s, h, i)
            for p in range(len(points.area)):
                x, z, area = points.x[p], points.z[p], points.area[p]
                gap = gap_of(arm, motion.g, motion.phi, x, z)
                opening = given(rows.openings, h[openings + p * L + i])
                slip = slip_of(arm, motion.g, motion.phi, x, z)
                at = slides + 2 * p * L + i
                area = area_of(contact, area, x, z, gap, slip)
                held = elastic_energy(law, gap, opening, slip[0] - h[at], slip[1] - h[at + L])
                book[ELASTIC * R + i] += area * held
                book_fracture(opening, book, i, area, law)


@inlined
def book_fracture(opening, book, i, area, law):
    """Book what opening has spent, with softening."""
    if opening is not None:
        book[FRACTURE * R + i] += area * fracture_energy_spent(law, opening)


@inlined
def book_weight(weight, book, s, n):
    """Book the potential energy in gravity, from the unloaded pillar on."""
    if weight is not None:
        for i in range(min(n, L)):
            book[GRAVITY * R + i] -= (
                weight[0] * s[i] + weight[1] * s[R + i] + weight[2] * s[2 * R + i]
            )

"""The ledger's accounts: a row of lanes for each, filled block by block, summed at samples.

The work of a force from one whole step to the next is the mean of its two values times the way.
So a force at step n acts over the half step before it and over the one after it, which are booked
apart: at a sample only the first half has been done.
"""

from dem.spatial.layout import LANES
from dem.spatial.layout import STRIDE as R
from numerics.jit import inlined

VISCOUS, BOUNDARY, WORK, FRICTION = 0, 1, 2, 3  # running sums, up to the step
AFTER = 4
VISCOUS_AFTER, BOUNDARY_AFTER, WORK_AFTER = 4, 5, 6  # what the step adds behind it
KINETIC, ROTATION, ELASTIC, FRACTURE, GRAVITY = 7, 8, 9, 10, 11  # states, filled at samples only
ACCOUNTS = 12

ACCOUNT_OF = {
    "kinetic": KINETIC,
    "rotation": ROTATION,
    "elastic": ELASTIC,
    "viscous": VISCOUS,
    "friction": FRICTION,
    "fracture": FRACTURE,
    "boundary": BOUNDARY,
    "gravity": GRAVITY,
    "work": WORK,
}


@inlined
def close(book, sums, energy, accounts, n, stride):
    """Add the accounts of step n to the running sums, and sample them where n is a sample.

    book : float array [ACCOUNTS * STRIDE] of the step, left empty. sums : the running accounts,
    [4 * STRIDE]. energy : float array [terms, samples], J. accounts : the account of each term.
    """
    for i in range(4 * R):
        sums[i] += book[i]
    if n % stride == 0:
        for k in range(accounts.size):
            a = accounts[k]
            lanes = book[a * R : a * R + LANES] if a >= KINETIC else sums[a * R : a * R + LANES]
            energy[k, n // stride] = total(lanes)
    for i in range(3 * R):
        sums[i] += book[4 * R + i]
    for i in range(ACCOUNTS * R):
        book[i] = 0.0


@inlined
def total(lanes):
    """Return the sum of all lanes, always in the same order."""
    s = 0.0
    for x in lanes:
        s += x
    return s

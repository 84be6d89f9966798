"""The stiffness of rigid blocks in the plane, assembled contact by contact."""

import numpy as np

from jointwave.compare.exact.blocks.system import contacts_of, relative, resistance


def stiffness(blocks):
    """Return the matrix of all contacts between blocks [3 N, 3 N], whose springs are evenly along
    them."""
    cut, own, c = blocks.cut, blocks.columns, blocks.contacts.column
    springs = np.stack([own.normal[c], own.shear[c]], axis=1)
    met = contacts_of(cut, cut.contacts, springs, 0 * springs)
    moved = relative(met, cut.count, 3)
    return (moved.T @ resistance(met, springs, 3) @ moved).toarray()

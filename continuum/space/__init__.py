"""The rock in space: elements, the jump across joints, and what receivers read of them."""

"""Rock masses in the plane, in plane strain: their rock, sides, loads, receivers and results."""

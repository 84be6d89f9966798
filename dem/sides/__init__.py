"""Actions on blocks from outside: sides, ends, loads, waves and moving bases."""

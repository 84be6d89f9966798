"""How far apart the engines are, why, and what it costs: exact solutions, metrics, report."""

"""What is drawn for each scene: a print figure, an interactive one and their numbers, as data."""

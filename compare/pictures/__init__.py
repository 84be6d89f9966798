"""What is drawn for each scene: a print figure, an interactive one and their numbers, as data."""

from compare.pictures.along import along_pillar
from compare.pictures.picture import KINDS, Picture
from compare.pictures.pictures import pictures_of

__all__ = ["KINDS", "Picture", "along_pillar", "pictures_of"]

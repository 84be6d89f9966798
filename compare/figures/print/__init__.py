"""Figures for papers: one column or one page wide, with embedded fonts, in two languages."""

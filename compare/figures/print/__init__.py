"""Figures for papers: of a column's or a page's width, their fonts embedded, in two languages."""

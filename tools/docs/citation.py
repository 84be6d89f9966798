"""How to cite, from CITATION.cff."""

from pathlib import Path

import yaml


def page(path: Path) -> str:
    """Return the software and the papers that it names as BibTeX."""
    about = yaml.safe_load(path.read_text(encoding="utf-8"))
    entries = [_software(about), *map(_article, about.get("references", []))]
    return "```bibtex\n" + "\n\n".join(entries) + "\n```"


def _software(about: dict) -> str:
    fields = {
        "title": about["title"],
        "author": f"{{{_authors(about)}}}",
        "version": about["version"],
        "note": about["license"],
    }
    return _entry("software", "jointwave", fields)


def _article(about: dict) -> str:
    fields = {
        "title": " ".join(about["title"].split()),
        "author": _authors(about),
        "journal": about["journal"],
        "volume": about["volume"],
        "number": about["issue"],
        "pages": f"{about['start']}--{about['end']}",
        "year": about["year"],
    }
    first = about["authors"][0]["family-names"].lower()
    return _entry("article", f"{first}{about['year']}", fields)


def _authors(about: dict) -> str:
    names = [a.get("name") or f"{a['family-names']}, {a['given-names']}" for a in about["authors"]]
    return " and ".join(names)


def _entry(kind: str, key: str, fields: dict) -> str:
    lines = [f"  {name} = {{{value}}}," for name, value in fields.items()]
    return "\n".join([f"@{kind}{{{key},", *lines, "}"])

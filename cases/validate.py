"""Validate a scene's tables against its model; each mistake is one line."""

import re
from itertools import islice
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from jointwave.cases.checks import pillar
from jointwave.cases.checks.rules import Wrong, of_quality, of_time
from jointwave.cases.errors import SceneError, all_of, nearest
from jointwave.cases.joints_at_places import spelled_out
from jointwave.cases.scene_type import Either
from jointwave.cases.schema.keys import model_in
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene

PLACE = re.compile(r"\.\d+(?=\.)")  # an index into a list of tables, as in `waves.0.file`

#: Message about allowed values for each pydantic error type.
ALLOWED = {
    "contradiction": "{allowed}",
    "extra_forbidden": "unknown key; allowed: ",
    "missing": "is required",
    "model_type": "must be a table",
    "dict_type": "must be a table",
    "list_type": "must be a list",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "string_type": "must be a string",
    "bool_type": "must be true or false",
    "finite_number": "must be a finite number",
    "literal_error": "must be {expected}",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "less_than": "must be less than {lt:g}",
    "less_than_equal": "must be at most {le:g}",
    "too_short": "must have {min_length} numbers",
    "too_long": "must have {max_length} numbers",
}


def validated(table: dict[str, Any], path: Path, given: frozenset[str]) -> Any:
    """Return a table as a scene; given : keys and tables that the user gave directly. Raises
    SceneError, one line per mistake, for an invalid scene."""
    asked = {PLACE.sub("", key) for key in given}
    where = f"{path} [{table['name']}]" if table.get("name") else str(path)
    if "domain" in table and "pillar" in table:
        raise SceneError(where, "pillar", None, "give [pillar] or [domain], not both")
    model: Any = RockMass if "domain" in table else Scene
    domain = table["domain"] if isinstance(table.get("domain"), dict) else {}
    size = domain.get("size")
    dimension = 3 if isinstance(size, list) and len(size) == 3 else 2
    context = {"folder": path.parent, "asked": asked, "dimension": dimension}
    try:
        scene = model.model_validate(spelled_out(table, where, context), context=context)
    except ValidationError as error:
        found = error.errors()
        own = [one for one in found if one["loc"][:1] == ("domain",)]
        if own and not {"size", "outline"} & set(domain):
            found = own  # without its file, the dimension of other tables is not known
        raise all_of(_error(where, one, model) for one in found) from None
    scene._where = where
    return checked(scene)


def _error(where: str, first: Any, model: Any) -> SceneError:
    kind, value, context = first["type"], first["input"], first.get("ctx", {})
    table = ""
    for part in first["loc"]:
        table += f"[{part}]" if isinstance(part, int) else f".{part}" if table else part
    key, allowed = table, ALLOWED.get(kind, first["msg"]).format(**context)
    if kind == "contradiction":
        key, value = context["key"], context["found"]
        key = f"{table}{key}" if key.startswith(".") else key
        allowed = allowed.replace("{table}", table)
    elif kind == "extra_forbidden":
        at = model
        for part in (one for one in first["loc"][:-1] if isinstance(one, str)):
            at = model_in(at.model_fields[part].annotation)
        known = [k for k in at.model_fields if k != "name" or at is not model]
        allowed += ", ".join(known) + nearest(str(first["loc"][-1]), known)
    elif kind == "list_type" and isinstance(value, dict):
        allowed = f"must be written [[{key}]]"
    if isinstance(value, dict) or kind == "missing":
        value = None
    return SceneError(where, key, value, allowed)


def checked(scene: Either) -> Either:
    """Return a scene. Raises SceneError, one line per contradiction, if its tables contradict each
    other: the first that each rule finds. An exception in a rule after that is its consequence."""
    own: Any = pillar
    if not scene.is_column:
        from jointwave.cases.checks import rock_mass as own  # with shapely
    found: list[Wrong] = []
    for rule in (*own.rules(scene), of_time(scene), of_quality(scene)):
        try:
            found.extend(islice(rule, 1))
        except PydanticCustomError as error:
            about = error.context or {}
            found.append((about["key"], about["found"], about["allowed"]))
        except Exception:
            if not found:
                raise
    if found:
        raise all_of(SceneError(scene.where, *one) for one in found)
    return scene

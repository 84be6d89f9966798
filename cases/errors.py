"""The two errors that a user meets: a scene that cannot be run, and a run that went unstable."""


class SceneError(ValueError):
    """A scene that cannot be simulated, in one line: where, which key, which value, what is allowed.

    Parameters
    ----------
    where : the scene file (or other source) that holds the mistake.
    key : dotted key, `pillar.length`; empty when the mistake is not in one key.
    value : the value that was found, or None when a key is missing or absent.
    allowed : what would be accepted, as a phrase.
    """

    def __init__(self, where: str, key: str, value: object, allowed: str) -> None:
        self.where, self.key, self.value, self.allowed = str(where), key, value, allowed
        found = "" if value is None else f" = {_short(value)}"
        subject = f"{key}{found}: " if key else ""
        super().__init__(_one_line(f"{where}: {subject}{allowed}"))


class UnstableError(RuntimeError):
    """A run that left its stability bound and was stopped; the message says what, where and when."""


def _short(value: object, width: int = 60) -> str:
    text = repr(value)
    return text if len(text) <= width else text[: width - 3] + "..."


def _one_line(text: str) -> str:
    return " ".join(text.split())

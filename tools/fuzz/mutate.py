"""Changes that leave a file readable for longer than changed bytes do: of numbers, words, lines."""

import random
import re

NUMBER = re.compile(rb"-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_]{2,}")
SPECIAL = b"0 -1 1e30 -1e30 1e-30 1e31 1e300 5e-324 nan inf 9223372036854775808 true [] {}".split()


def changed(data: bytes, seed: int) -> bytes:
    """Return a text with one to three of its numbers, words or lines changed."""
    chance = random.Random(seed)
    for _ in range(chance.randint(1, 3)):
        data = chance.choice([_number, _number, _word, _lines])(data, chance)
    return data


def _number(data: bytes, chance: random.Random) -> bytes:
    """Scale a number, or put something else in its place."""
    found = [*NUMBER.finditer(data)]
    if not found:
        return data
    one = chance.choice(found)
    scaled = float(one[0][:300]) * 10 ** chance.uniform(-9, 9)
    whole = str(chance.randint(-3, 20)).encode()
    new = chance.choice([repr(scaled).encode(), whole, chance.choice(SPECIAL)])
    return data[: one.start()] + new + data[one.end() :]


def _word(data: bytes, chance: random.Random) -> bytes:
    found = [*WORD.finditer(data)]
    if not found:
        return data
    one = chance.choice(found)
    return data[: one.start()] + chance.choice(found)[0] + data[one.end() :]


def _lines(data: bytes, chance: random.Random) -> bytes:
    lines = data.split(b"\n")
    i, j = chance.randrange(len(lines)), chance.randrange(len(lines))
    line = lines.pop(i) if chance.random() < 0.7 else lines[i]
    if chance.random() < 0.6:
        lines.insert(j, line)
    return b"\n".join(lines)

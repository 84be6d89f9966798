"""One target under the fuzzer: `python driver.py TARGET CORPUS [libFuzzer's options]`.

Only what reads is instrumented: compiled kernels would be compiled anew.
"""

import os
import sys
import tempfile
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / ".fuzz"), str(Path(__file__).parent)]

import atheris  # noqa: E402

READERS = ["cases", "compare", "tomllib", "meshio", "continuum.mesh", "targets"]


def main() -> None:
    """Fill the corpus, and let the target meet what the fuzzer makes of it."""
    name, corpus, options = sys.argv[1], Path(sys.argv[2]), sys.argv[3:]
    with atheris.instrument_imports(include=READERS):
        import targets
    from mutate import changed
    from seeds import seeds

    os.environ["JOINTWAVE_MEMORY"] = targets.MEMORY
    corpus.mkdir(parents=True)
    outcomes: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        for load in ROOT.glob("cases/*/*.csv"):
            (place / load.name).write_bytes(load.read_bytes())
        shipped = seeds(name)
        for i, seed in enumerate(shipped):
            (corpus / f"{i:03d}").write_bytes(seed)
            targets.TARGETS[name](seed, place)  # what is imported and compiled once has no limit

        def meet(data: bytes) -> None:
            outcomes[targets.met(name, data, place)] += 1
            if outcomes.total() % 50 == 0:  # the fuzzer ends the process without a word
                print("outcomes:", dict(outcomes), file=sys.stderr, flush=True)

        def mutate(data: bytes, largest: int, seed: int) -> bytes:
            if seed % 4 == 0:
                return atheris.Mutate(data, largest)
            # Bytes that are no text are soon refused, and so is what has been changed often.
            return changed(shipped[seed % len(shipped)] if seed % 2 else data, seed)[:largest]

        atheris.Setup([sys.argv[0], *options, str(corpus)], meet, custom_mutator=mutate)
        atheris.Fuzz()


if __name__ == "__main__":
    main()

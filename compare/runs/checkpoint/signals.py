"""Signals by which the user or the system ends this program."""

import signal
from functools import cache
from types import FrameType

#: The effect of a signal on the program, in words.
WORDS: dict[int, str] = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated",
    signal.SIGHUP: "ended with its terminal",
}


class Ended(BaseException):
    """Request to end the program; not an Exception or KeyboardInterrupt, which libraries catch.

    number : of the signal. code : of the program's exit.
    """

    def __init__(self, number: int) -> None:
        super().__init__(WORDS[number])
        self.code = 128 + number  # as in shells


class Signals:
    """Signal handler: raises Ended or, while `patient`, keeps the signal pending until `act`.

    A second signal takes effect immediately; after Ended signals have their default action.

    asked : number of the pending signal, 0 for none.
    """

    def __init__(self, patient: bool = False) -> None:
        self.patient, self.asked = patient, 0

    def install(self) -> None:
        """Install handlers, except for signals that the parent process ignores."""
        for number in WORDS:
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self._arrived)

    def act(self) -> None:
        """Raise Ended if a signal is pending."""
        if self.asked:
            raise Ended(self.asked)

    def _arrived(self, number: int, frame: FrameType | None) -> None:
        first, self.asked = not self.asked, number
        if not (self.patient and first):
            for each in WORDS:
                signal.signal(each, signal.SIG_DFL)
            raise Ended(number)


@cache
def watched() -> Signals:
    """Return the signals of the program, with handlers installed."""
    signals = Signals()
    signals.install()
    return signals

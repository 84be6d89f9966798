"""Signals by which the user or the system ends this program."""

import signal
from functools import cache
from types import FrameType

WORDS = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated",
    signal.SIGHUP: "ended with its terminal",
}


class Ended(BaseException):
    """This program is to end now. No Exception, and not KeyboardInterrupt, which libraries catch.

    number : of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(word(number))
        self.number = number


class Signals:
    """What signals do here: raise Ended, or, while `patient`, wait to be asked for.

    A second signal does not wait; what comes after Ended is raised ends the program by itself.

    asked : number of the signal that waits; 0 where none does.
    """

    def __init__(self, patient: bool = False) -> None:
        self.patient, self.asked = patient, 0

    def install(self) -> None:
        """Take over the signals, but for those that whoever started this program ignores."""
        for number in WORDS:
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self._arrived)

    def act(self) -> None:
        """Raise Ended where a signal waits."""
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
    """Return the signals of this program, taken over from now on."""
    signals = Signals()
    signals.install()
    return signals


def word(number: int) -> str:
    """Return what a signal has done to this program."""
    return WORDS[signal.Signals(number)]


def exit_code(number: int) -> int:
    """Return the exit code that shells give to a program that a signal has ended."""
    return 128 + number

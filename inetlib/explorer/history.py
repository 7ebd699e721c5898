"""Undo and redo: the choices of a tab, one after the other."""

from .choices import NAMES, Choice

MOST = 100  # choices that are kept
PAUSE = 2.0  # seconds: changes of the same values that follow faster are one, as those of a drag


class History:
    """The choices so far, and those that were taken back."""

    def __init__(self, first: Choice):
        self.past, self.next = [first], []
        self._names, self._time, self._drag = set[str](), 0.0, 0

    def take(self, choice: Choice, now: float, drag: int = 0) -> None:
        """A new choice at a time in seconds, in the drag of this number, 0 in none.

        After it there is nothing to redo."""
        names = differing(self.past[-1], choice)
        if not names:
            return
        near = now - self._time < PAUSE or 0 < drag == self._drag
        one = names == self._names and near
        self._names, self._time, self._drag = names, now, drag
        self.past[-1 if one else len(self.past) :] = [choice]
        del self.past[:-MOST], self.next[:]

    def undo(self) -> Choice:
        """The choice before, where there is one."""
        if len(self.past) > 1:
            self.next.append(self.past.pop())
        self._names = set()
        return self.past[-1]

    def redo(self) -> Choice:
        """The choice that was taken back last, where there is one."""
        if self.next:
            self.past.append(self.next.pop())
        self._names = set()
        return self.past[-1]


def differing(one: Choice, two: Choice) -> set[str]:
    """The names of the values in which two choices differ."""
    return {name for name in NAMES if getattr(one, name) != getattr(two, name)}

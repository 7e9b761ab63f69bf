"""Errors that are told to a person, without a trace."""

import difflib
import errno
import os
import re
from collections.abc import Iterable

UNCARRIED = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u034f\u061c\u115f\u1160\u17b4\u17b5\u180e\u200b\u200e\u200f"
    "\u2028-\u202e\u2060-\u206f\u3164\uffa0\ud800-\udfff\ufdd0-\ufdef"
    "\ufeff\ufff9-\ufffb\ufffe\uffff\U000e0000-\U000e007f]"
)
"""Characters that control lines or the direction of writing, or that nobody sees (but for those
that join letters), and halves that no file can hold."""

NO_MEMORY = (
    "there is not enough memory for it: a number may be far too large; if none is, fewer --jobs "
    "leave more for each"
)

_NEXT = {
    errno.EAGAIN: "no more processes or threads are started (ulimit -u); fewer --jobs need less",
    errno.EMFILE: "fewer --jobs need less, or ulimit -n gives more",
    errno.ENOMEM: "fewer --jobs leave more for each",
}


def refused(error: OSError) -> str:
    """Return what the system refuses as a sentence, with what to do where that is known."""
    reason = error.strerror or str(error) or type(error).__name__
    place = error.filename2 or error.filename or _gone()
    hint = _NEXT.get(error.errno or 0, "")
    return ": ".join(filter(None, (str(place or ""), reason, hint)))


def _gone() -> str:
    """Return what is not there although nobody names it: the folder that the command is in."""
    try:
        os.getcwd()
    except OSError:
        return "the folder that this command was started in is gone; start it in another one"
    return ""


def printable(text: str) -> str:
    """Return a text in which what no text can carry is written out."""
    return UNCARRIED.sub(lambda sign: sign[0].encode("unicode_escape").decode(), text)


def meant(given: str, known: Iterable[str]) -> str:
    """Return a question after the known name that was probably meant, or nothing."""
    close = difflib.get_close_matches(given, list(known), n=1, cutoff=0.6)
    return f" (did you mean {close[0]}?)" if close else ""


def allowed_names(given: str, allowed: Iterable[str]) -> str:
    """Return the allowed names, and the one that was probably meant."""
    names = list(allowed)
    return f"allowed: {', '.join(names)}{meant(given, names)}"


class UserError(Exception):
    """The user's input is wrong: one or more sentences, each complete in itself (exit code 2)."""

    def __init__(self, problems: str | Iterable[str]) -> None:
        told = [problems] if isinstance(problems, str) else problems
        self.problems = [printable(problem) for problem in told]
        super().__init__("\n".join(self.problems))

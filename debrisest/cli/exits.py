"""How a command ends: 0 well, 1 something is wrong, 2 wrong input, 130 or 143 interrupted."""

import errno
import re
import sys
from collections.abc import Iterator, Sequence
from typing import Any

from typer import BadParameter
from typer.core import TyperGroup

from debrisest.cli.streams import steady
from debrisest.errors import NO_MEMORY, UserError, meant, refused
from debrisest.interrupts import SENTENCE

_PLACE = re.compile(r"^([^\n]*?):(\d+):\d+(?=: )")
_MOST_ALIKE = 20
"""Problems that differ in their place alone, beyond which only the first is told."""


class Commands(TyperGroup):
    """The commands; whatever stops one is told in sentences, without a trace."""

    def main(self, *arguments: Any, **options: Any) -> Any:
        """Read the arguments, print help or run a command, and end."""
        with steady():
            try:
                try:
                    return super().main(*arguments, **options)
                finally:
                    sys.stdout.flush()
            except OSError as error:
                _stop(2, refused(error))

    def invoke(self, ctx: Any) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except BadParameter as error:
            error.message = error.message.replace("Value error, ", "") + _meant(error)
            raise
        except UserError as error:
            _stop(2, *folded(error.problems))
        except OSError as error:
            if error.errno == errno.EPIPE:
                raise
            _stop(2, refused(error))
        except MemoryError:
            _stop(2, NO_MEMORY)
        except ImportError as error:
            if "failed to map" not in str(error):
                raise
            _stop(2, NO_MEMORY)
        except KeyboardInterrupt as error:
            _stop(getattr(error, "exit_code", 130), SENTENCE)


def folded(problems: Sequence[str]) -> Iterator[str]:
    """Yield problems, but only the first of many that differ in their place alone."""
    alike: dict[str, list[str]] = {}
    for problem in problems:
        alike.setdefault(_PLACE.sub(r"\1", problem), []).append(problem)
    for several in alike.values():
        if len(several) > _MOST_ALIKE and _PLACE.match(several[0]):
            yield several[0]
            lines = [found[2] for each in several[1:] if (found := _PLACE.match(each))]
            yield f"  and {len(lines)} more like this, in lines {lines[0]} to {lines[-1]}"
        else:
            yield from several


def exit_if(wrong: bool) -> None:
    """End with exit code 1 if something is wrong."""
    if wrong:
        raise SystemExit(1)


def _meant(error: BadParameter) -> str:
    """Return a question after the word that was meant where an option has a few of them."""
    if "is not one of" not in error.message:
        return ""
    given, *words = re.findall("'(.*?)'", error.message)
    return meant(given, words)


def _stop(code: int, *sentences: str) -> None:
    for sentence in sentences:
        print(sentence, file=sys.stderr)
    raise SystemExit(code) from None

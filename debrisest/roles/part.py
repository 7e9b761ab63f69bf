"""The base of every part that a scenario can name."""

from abc import ABC
from typing import Any, ClassVar

from debrisest.quantity import Quantity
from debrisest.roles.keys import Keys
from debrisest.vocabulary import VOCABULARY


class Part(Keys, ABC):
    """A part of a scenario, told apart by its ``kind``; ``version`` counts changes of results."""

    role: ClassVar[str]
    """Its place in the catalog."""
    version: ClassVar[int] = 1
    plugin: ClassVar[dict[str, str]] = {}
    """Name and digest of the plug-in that it comes from."""
    needs: ClassVar[tuple[str, ...]] = ()
    """Datasets that a part before this one must give."""
    gives: ClassVar[tuple[str, ...]] = ()
    """Datasets that later parts can count on."""
    extends: ClassVar[tuple[str, ...]] = ()
    """Those of them that several parts give together, each of them its share."""

    libraries: ClassVar[tuple[str, ...]] = ()
    """Modules of the extra ``vision`` that it needs beside the core's."""
    declares: ClassVar[dict[str, Quantity]] = {}
    """Datasets that nobody else declares, such as those of a plug-in; they join the vocabulary."""

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Add what the part declares to the vocabulary."""
        VOCABULARY.update(cls.declares)

    @classmethod
    def can_give(cls) -> tuple[str, ...]:
        """Return the datasets that parts of this kind give."""
        return cls.gives

    @property
    def given(self) -> tuple[str, ...]:
        """Return the datasets that this very part gives, as its keys have it."""
        return self.can_give()

    @property
    def needed(self) -> tuple[str, ...]:
        """Return the datasets that this very part needs, as its keys have it."""
        return self.needs

    def fingerprint(self) -> dict[str, Any]:
        """Return what this part's results depend on: its keys, its version, its plug-in."""
        return self.model_dump(mode="json") | {"version": self.version} | self.plugin

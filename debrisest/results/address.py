"""Where a file of results lies, and what its name says."""

import re
from pathlib import Path
from typing import Any, NamedTuple, Self

STAGES = ("simulate", "recover", "filter", "assess")
_NAME = re.compile(rf"({'|'.join(STAGES)})(?:-(.+))?\.(\d{{6,}})\.h5")


class Address(NamedTuple):
    """What a file holds: a stage of a case from one run on, of an estimator but for `simulate`."""

    scenario: str
    case: str
    stage: str
    estimator: str
    """Empty in `simulate`, which all estimators of a case share."""
    first_run: int

    @classmethod
    def of(cls, path: Path) -> Self | None:
        """Return the address of ``<scenario>/<case>/<file>``, if the file is named like one."""
        found = _NAME.fullmatch(path.name)
        if found is None or (found[1] == "simulate") != (found[2] is None):
            return None
        folder = path.absolute().parent
        return cls(folder.parent.name, folder.name, found[1], found[2] or "", int(found[3]))

    def path(self, out: Path) -> Path:
        """Return the file's path below the folder of all results."""
        name = f"{self.stage}-{self.estimator}" if self.estimator else self.stage
        return out / self.scenario / self.case / f"{name}.{self.first_run:06d}.h5"

    @property
    def attributes(self) -> dict[str, Any]:
        """Return what the file's own attributes say of where it belongs, whatever its folder."""
        wanted = self._asdict()
        del wanted["scenario"]
        return wanted

    @property
    def name(self) -> str:
        """Return what the stage is called in messages."""
        return f"{self.scenario} {self.case}: {self.stage} {self.estimator}".rstrip()

    @property
    def order(self) -> tuple[object, ...]:
        """Return what sorts files: cases as people count them, what is computed first before."""
        case: list[object] = list(re.split(r"(\d+)", self.case))
        case[1::2] = map(int, re.findall(r"\d+", self.case))
        return (case, self.first_run, STAGES.index(self.stage), self.estimator)

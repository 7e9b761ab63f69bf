"""Put the commit into a package that is built, where its checkout cannot be asked later."""

import runpy
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CommitHook(BuildHookInterface):
    """Add the file that names the commit, unless the checkout itself is installed."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Write the file and have it packed."""
        package = Path(self.root) / "debrisest"
        revision = runpy.run_path(str(package / "revision.py"))
        if version != "editable" and (told := revision["commit"](package)):
            file = Path(tempfile.mkdtemp()) / revision["BUILT"]
            file.write_text(f"{told} {revision['digest'](package)}\n")
            build_data["force_include"][str(file)] = f"debrisest/{file.name}"

"""The commit that the code is of."""

import os
import subprocess
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent
BUILT = "COMMIT"
"""The file of an installed package that names the commit it was built from."""


@cache
def commit(package: Path = _PACKAGE) -> str:
    """Return the commit of a checkout or of what a package was built from, or nothing.

    ``+changed`` follows where the package of the checkout is not as it was committed.
    """
    if (package.parent / ".git").exists():
        changed = _git(package, "status", "--porcelain", "--", package.name)
        return _git(package, "rev-parse", "HEAD") + "+changed" * bool(changed)
    built = package / BUILT
    return built.read_text().strip() if built.is_file() else ""


def _git(package: Path, *arguments: str) -> str:
    """Return what git says of the checkout; nothing where there is no git, or no commit yet."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")}
    try:
        done = subprocess.run(
            ["git", *arguments],
            cwd=package.parent,
            env=environment | {"GIT_OPTIONAL_LOCKS": "0"},
            capture_output=True,
            text=True,
        )
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""

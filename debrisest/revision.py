"""The commit that the code is of."""

import os
import subprocess
from functools import cache
from hashlib import sha256
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent
BUILT = "COMMIT"
"""The file of an installed package that names the commit it was built from, and its source."""
_PATIENCE_S = 10.0
_TRUSTED = ("-c", "safe.directory=*", "-c", "core.fsmonitor=false")
"""A checkout may be somebody else's: its code runs already."""


@cache
def commit(package: Path = _PACKAGE) -> str:
    """Return the commit of a checkout or of what a package was built from, or nothing.

    ``+changed`` follows where the package is not as it was committed, or nobody can tell.
    """
    built = package / BUILT
    if built.is_file():
        told, *of = built.read_text(errors="replace").split()[:2] or [""]
        return told + "+changed" * (told != "" and of not in ([], [digest(package)]))
    if not (package.parent / ".git").exists():
        return ""
    told, *_ = (_git(package, "rev-parse", "HEAD", f"HEAD:./{package.name}") or "").split() or [""]
    status = ("status", "--porcelain", "--untracked-files=all", "--", package.name)
    return told + "+changed" * bool(told and _git(package, *status) != "")


def digest(package: Path = _PACKAGE) -> str:
    """Return a digest of a package's source."""
    source = sha256()
    for path in sorted(package.rglob("*.py")):
        source.update(f"{path.relative_to(package).as_posix()}\0".encode() + path.read_bytes())
    return source.hexdigest()[:16]


def _git(package: Path, *arguments: str) -> str | None:
    """Return what git says of the checkout, or None: without git, or a commit of the package."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")}
    try:
        done = subprocess.run(
            ["git", *_TRUSTED, *arguments],
            cwd=package.parent,
            env=environment | {"GIT_OPTIONAL_LOCKS": "0"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_PATIENCE_S,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() if done.returncode == 0 else None

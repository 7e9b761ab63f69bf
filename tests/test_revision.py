"""The commit of the code: in checkouts, worktrees, packed references, and built packages."""

import subprocess
from pathlib import Path

import pytest

from debrisest.revision import BUILT, commit


def git(folder: Path, *arguments: str) -> str:
    who = ("-c", "user.name=a", "-c", "user.email=a@b")
    command = ["git", "-C", str(folder), *who, *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package in a checkout of its own."""
    package = tmp_path / "checkout" / "pkg"
    package.mkdir(parents=True)
    (package / "code.py").write_text("1\n")
    git(package.parent, "init", "-q")
    git(package.parent, "add", ".")
    git(package.parent, "commit", "-qm", "first")
    return package


def test_a_checkout(package: Path) -> None:
    told = commit(package)
    assert told == git(package, "rev-parse", "HEAD")
    assert len(told) == 40


def test_packed_references(package: Path) -> None:
    git(package, "pack-refs", "--all")
    assert commit(package) == git(package, "rev-parse", "HEAD")


def test_a_worktree(package: Path, tmp_path: Path) -> None:
    git(package, "worktree", "add", "-q", str(tmp_path / "tree"), "-b", "other")
    assert commit(tmp_path / "tree" / "pkg") == git(package, "rev-parse", "HEAD")


@pytest.mark.parametrize("name", ["code.py", "new.py"])
def test_a_changed_package_is_told(name: str, package: Path) -> None:
    (package / name).write_text("2\n")
    assert commit(package) == git(package, "rev-parse", "HEAD") + "+changed"


def test_what_lies_beside_the_package_is_no_change(package: Path) -> None:
    (package.parent / "results").write_text("mine\n")
    assert commit(package) == git(package, "rev-parse", "HEAD")


def test_a_built_package_names_its_commit(tmp_path: Path) -> None:
    (tmp_path / BUILT).write_text("0123abc\n")
    assert commit(tmp_path) == "0123abc"


def test_a_package_inside_the_repository_of_another_has_none(package: Path) -> None:
    inner = package.parent / "lib" / "python" / "pkg"
    inner.mkdir(parents=True)
    assert commit(inner) == ""


def test_without_git_there_is_none(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    assert commit(package) == ""

"""The commit of the code: in checkouts, worktrees, packed references, and built packages."""

import os
import subprocess
from pathlib import Path

import pytest

from debrisest import revision
from debrisest.revision import BUILT, commit, digest


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


def test_a_built_package_that_was_edited_is_told(tmp_path: Path) -> None:
    (tmp_path / "code.py").write_text("1\n")
    (tmp_path / BUILT).write_text(f"0123abc {digest(tmp_path)}\n")
    assert commit(tmp_path) == "0123abc"
    (tmp_path / "code.py").write_text("2\n")
    commit.cache_clear()
    assert commit(tmp_path) == "0123abc+changed"


def test_a_built_package_beside_a_repository_names_its_own_commit(package: Path) -> None:
    (package / BUILT).write_text("0123abc\n")
    assert commit(package) == "0123abc"


def test_a_package_that_a_repository_does_not_hold_has_none(package: Path) -> None:
    (package.parent / "other").mkdir()
    (package.parent / "other" / "code.py").write_text("1\n")
    assert commit(package.parent / "other") == ""


def test_a_repository_without_a_commit_has_none(tmp_path: Path) -> None:
    (tmp_path / "pkg").mkdir()
    (tmp_path / "pkg" / "code.py").write_text("1\n")
    git(tmp_path, "init", "-q")
    assert commit(tmp_path / "pkg") == ""


def test_a_new_file_is_told_though_the_settings_hide_it(package: Path) -> None:
    git(package, "config", "status.showUntrackedFiles", "no")
    (package / "new.py").write_text("2\n")
    assert commit(package).endswith("+changed")


def test_a_checkout_of_somebody_else(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told = git(package, "rev-parse", "HEAD")
    try:
        for path in (package.parent, package.parent / ".git"):
            os.chown(path, 65534, 65534)
    except PermissionError:
        pytest.skip("only root gives files away")
    monkeypatch.setenv("HOME", str(package))  # where no settings allow it
    assert commit(package) == told


def test_where_git_cannot_tell_it_counts_as_changed(package: Path) -> None:
    (package.parent / ".git" / "index").write_bytes(b"DIRC" + bytes(40))
    assert commit(package) == git(package, "rev-parse", "HEAD") + "+changed"


@pytest.mark.parametrize("said", ["sleep 60", r"printf '\377\376'; exit 1"])
def test_a_git_that_hangs_or_says_no_text(
    said: str, package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tool = tmp_path / "bin" / "git"
    tool.parent.mkdir()
    tool.write_text(f"#!/bin/sh\n{said}\n")
    tool.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tool.parent}:{os.environ['PATH']}")
    monkeypatch.setattr(revision, "_PATIENCE_S", 0.5)
    assert commit(package) == ""

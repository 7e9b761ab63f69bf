"""Machine code on disk follows from the source of all loops."""

from pathlib import Path

import pytest

from debrisest import compiled
from debrisest.files import lock


def test_a_change_of_any_loops_is_another_folder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    called, other = tmp_path / "deep" / "called_loops.py", tmp_path / "other.py"
    called.parent.mkdir()
    folders = []
    for text, beside in (("a = 1", ""), ("a = 1", "b = 2"), ("a = 2", "")):
        called.write_text(text)
        other.write_text(beside)
        folders.append(compiled._cache.__wrapped__(""))
    assert folders[0] == folders[1] != folders[2]
    assert folders[0].parent == tmp_path / "__pycache__"
    assert compiled._cache.__wrapped__("/mine").parent == Path("/mine")


def test_what_others_keep_of_numba_stays_where_it_was() -> None:
    numba = pytest.importorskip("numba")
    before = numba.config.CACHE_DIR
    assert compiled.compiled(lambda x: x + 1)(1) == 2
    assert before == numba.config.CACHE_DIR


def test_a_kernel_is_compiled_by_one_process_at_a_time(tmp_path: Path) -> None:
    path = tmp_path / "new" / "kernel.lock"

    def held(_: object) -> bool:
        with path.open("a") as file, pytest.raises(BlockingIOError):
            lock(file.fileno())
        return True

    assert compiled._by_one_process(held, path)(())
    with path.open("a") as file:
        lock(file.fileno())
    assert compiled._by_one_process(len, path / "below a file")("abc") == 3

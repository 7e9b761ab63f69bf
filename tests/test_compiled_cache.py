"""Machine code on disk follows from the source of the loops that a kernel can call."""

from importlib import import_module
from pathlib import Path

import pytest

from debrisest import compiled
from debrisest.files import lock


def test_a_change_of_loops_that_are_called_is_another_folder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    monkeypatch.syspath_prepend(tmp_path)
    inner = "def inner(): ..."
    sources = {
        "inner_loops": inner,
        "outer_loops": "from inner_loops import inner\ndef outer(): inner()",
        "caller_loops": "from outer_loops import outer\ndef caller(): outer()",
        "other_loops": "def other(): ...",
    }
    for name, text in sources.items():
        (tmp_path / f"{name}.py").write_text(text)
    caller = import_module("caller_loops").caller
    other = import_module("other_loops").other
    assert compiled._reached("caller_loops") == ["caller_loops", "inner_loops", "outer_loops"]
    before = compiled._cache(caller, ""), compiled._cache(other, "")
    (tmp_path / "inner_loops.py").write_text(inner + "\n")
    assert compiled._cache(caller, "") != before[0]
    assert compiled._cache(other, "") == before[1] == compiled._cache(other, "")
    assert before[0].parent == tmp_path / "__pycache__"
    assert compiled._cache(caller, "/mine").parent == Path("/mine")


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

"""The example of docs/plugins.md does what the guide says."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

GUIDE = (Path(__file__).parents[2] / "docs" / "plugins.md").read_text(encoding="utf-8")


def test_the_shortest_example(
    tmp_path: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (example,) = re.findall(r"^```python\n(.*?)^```", GUIDE, re.M | re.S)
    (command,) = re.findall(r"^```sh\ndebrisest (.*?)\n```", GUIDE, re.M | re.S)
    Path("cautious.py").write_text(example)
    done = cli(*shlex.split(command), "--jobs", 1, "--runs", 1, "--quiet")
    assert done.exit_code == 0, done.stderr
    assert "Rate and attitude after the filter" in done.stdout

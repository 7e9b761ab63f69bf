"""The report in a real browser without a head: what it says, asks for, and how wide it is."""

import json
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("jinja2")
NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
BROWSER = next(filter(None, map(shutil.which, NAMES)), "")
pytestmark = pytest.mark.skipif(not BROWSER, reason="no chromium is installed")

ALONE = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-extensions",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-default-apps", "--host-resolver-rules=MAP * ~NOTFOUND", "--enable-logging=stderr",
)  # fmt: skip
TOLD = """<script>
var words = document.getElementById("words");
words.value = "slow triad"; words.dispatchEvent(new Event("input"));
document.querySelectorAll(".sortable th")[6].click();
var html = document.documentElement, shown = document.getElementById("shown").textContent;
html.dataset.told = JSON.stringify([html.scrollWidth, window.innerWidth, shown]);
</script></body>"""


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory, reference: Path, cli: Callable) -> Path:
    """The report of the small scenario, which then tells of itself."""
    path = tmp_path_factory.mktemp("browser") / "report.html"
    config = Path(__file__).parents[2] / "scenarios" / "small.yaml"
    assert cli("report", config, "--out", reference, "--to", path).exit_code == 0
    path.write_text(path.read_text(encoding="utf-8").replace("</body>", TOLD), encoding="utf-8")
    return path


def browse(page: Path, folder: Path, width: int, *options: str) -> subprocess.CompletedProcess:
    own = (f"--user-data-dir={folder / 'profile'}", f"--window-size={width},900")
    command = [BROWSER, *ALONE, *own, *options, page.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)


@pytest.mark.parametrize("width", [1280, 520])
def test_it_is_as_wide_as_the_window_and_its_script_runs(
    width: int, report: Path, tmp_path: Path
) -> None:
    done = browse(report, tmp_path, width, "--dump-dom")
    found = re.search(r'data-told="([^"]*)"', done.stdout)
    assert found, done.stderr
    wide, window, shown = json.loads(found[1].replace("&quot;", '"'))
    assert wide <= window <= width
    some, of = map(int, re.findall(r"\d+", shown))
    assert 0 < some < of
    assert "CONSOLE" not in done.stderr


def test_it_asks_for_nothing_else(report: Path, tmp_path: Path) -> None:
    log = tmp_path / "net.json"
    browse(report, tmp_path, 1280, f"--log-net-log={log}", "--dump-dom")
    asked = re.findall(r'"url":"((?:https?|wss?|ftp):[^"]*)"', log.read_text(errors="replace"))
    own = re.compile(r"https?://[a-z0-9.]*(google|googleapis|gstatic|chromium)\.[a-z]+/")
    assert [url for url in asked if not own.match(url)] == []


def test_an_error_and_a_request_would_be_seen(tmp_path: Path) -> None:
    page, log = tmp_path / "page.html", tmp_path / "net.json"
    page.write_text("<body><img src='http://there.example/x.png'/><script>x.y;</script></body>")
    done = browse(page, tmp_path, 1280, f"--log-net-log={log}", "--dump-dom")
    assert "CONSOLE" in done.stderr
    assert "http://there.example/x.png" in log.read_text(errors="replace")

"""The text of a file, or one sentence on why it is none."""

from pathlib import Path

from debrisest.errors import UserError
from debrisest.files import content

_WIDE = (b"\xff\xfe", b"\xfe\xff")  # byte-order marks of UTF-16


def read_text(path: Path) -> str:
    r"""Return the UTF-8 text of a file, without a byte-order mark and with ``\n`` as line end.

    Raises `UserError` for what is not there, not readable, empty, binary or in another encoding.
    """
    raw = _bytes(path)
    if raw[:2] in _WIDE:
        raise UserError(f"{path}:1: this text is in UTF-16; save it as UTF-8")
    if not raw.removeprefix(b"\xef\xbb\xbf").strip():
        raise UserError(f"{path}: the file is empty")
    if (at := raw.find(b"\0")) >= 0:
        message = "a NUL byte: the file is binary or damaged; export it again as text"
        raise UserError(f"{path}:{_line(raw, at)}: {message}")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        message = f"byte 0x{raw[error.start]:02x} is not UTF-8 text; save the file as UTF-8"
        raise UserError(f"{path}:{_line(raw, error.start)}: {message}") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _bytes(path: Path) -> bytes:
    if path.is_dir():
        raise UserError(f"{path}: this is a folder; give a file")
    try:
        return content(path)
    except FileNotFoundError:
        raise UserError(f"{path}: there is no such file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"{path}: cannot be read: {reason}") from None


def _line(raw: bytes, at: int) -> int:
    head = raw[:at].replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return head.count(b"\n") + 1

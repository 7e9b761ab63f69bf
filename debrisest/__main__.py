"""The start of the command line, also as ``python -m debrisest``."""

from debrisest import interrupts


def main() -> None:
    """Listen to Ctrl-C, then import the command line and run it."""
    interrupts.listen()
    from debrisest.cli import main as run

    try:
        run()
    finally:
        interrupts.ignore()


if __name__ == "__main__":
    main()

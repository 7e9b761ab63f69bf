"""The command line: thin commands, whose heavy imports stay inside them."""

from debrisest.cli.app import app, main

__all__ = ["app", "main"]

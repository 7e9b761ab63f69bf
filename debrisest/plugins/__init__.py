"""Parts from outside the package."""

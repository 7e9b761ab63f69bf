"""``python -m debrisest``."""

from debrisest.cli import main

if __name__ == "__main__":
    main()

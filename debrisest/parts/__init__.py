"""What a scenario can name: the keys of each part, and how it calls the numerics."""

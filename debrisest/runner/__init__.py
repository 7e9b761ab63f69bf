"""The runner: what has to run, where, and the stages it runs."""

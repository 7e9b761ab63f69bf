"""Tables beside published values: cells, verdicts, rendering."""

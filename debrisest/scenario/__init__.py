"""From YAML files to validated scenarios."""

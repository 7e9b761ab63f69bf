"""All that was found of some scenarios as one file of HTML that needs nothing else."""

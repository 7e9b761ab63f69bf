"""Two results beside each other: what differs in the scenario, and in the figures of each cell."""

"""Maximum a posteriori over all frames so far, for motions without process noise."""

"""Reading what people have: tracks, poses, calibrations and body points, in their files."""

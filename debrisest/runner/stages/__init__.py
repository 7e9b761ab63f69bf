"""The stages simulate, recover, filter and assess: arrays in, arrays out."""

"""From programmed to machine coordinates: units, rotation, scaling, mirror, offsets, coordinate systems."""

"""The exchange between units: blocks, commands, states; and the base of all units."""

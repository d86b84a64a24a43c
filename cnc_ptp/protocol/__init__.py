"""What units hand each other: blocks, commands, states; and the base of all units."""

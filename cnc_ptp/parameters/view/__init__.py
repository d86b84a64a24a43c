"""The parameter sets as the kernel uses them: one frozen class a kind of unit, in kernel units."""

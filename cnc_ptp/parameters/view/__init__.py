"""The parameter sets as the kernel uses them: one frozen class per kind of unit, in kernel units."""

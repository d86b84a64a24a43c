"""The PLC: scenario, commands to all units, master/slave groups, external setpoints and cam tables."""

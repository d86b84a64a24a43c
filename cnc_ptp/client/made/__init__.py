"""The commands of units as methods, made from the tables: `python -m cnc_ptp.client.make_commands`."""

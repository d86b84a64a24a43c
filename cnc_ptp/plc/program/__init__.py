"""A PLC in a file: a class of the user's, called once in each cycle block (docs/plc.md)."""

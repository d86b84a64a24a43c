"""The folder of NC programs, and programs as polylines."""

"""Commands for a running machine: status, watch, do, jog."""

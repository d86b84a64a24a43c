"""The HLI as topics: control and status of each axis, spindle and channel, emergency stop of the machine."""

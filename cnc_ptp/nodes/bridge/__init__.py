"""Parts of the plc_bridge: jogging, couplings, joint states, numbered messages."""

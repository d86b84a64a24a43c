"""The HLI: what an external PLC commands object by object, checked, arbitrated and turned into commands of blocks."""

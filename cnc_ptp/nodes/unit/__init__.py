"""The node around a unit: what arrives, blocks, services, actions, parameters, diagnostics."""

"""The node around a unit: messages, blocks, services, actions, parameters, diagnostics."""

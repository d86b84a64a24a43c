"""What no single value shows: problems stop a node, notices go to the log."""

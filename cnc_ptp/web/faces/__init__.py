"""What pages see of a machine, whether it runs or was recorded."""

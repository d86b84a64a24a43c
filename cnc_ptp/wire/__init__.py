"""Blocks as bytes: the CDR of ROS messages, the same on a topic and in a recording."""

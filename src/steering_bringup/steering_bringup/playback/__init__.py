"""A bag published on ROS topics: sources of messages, pacing, keys, publishers."""

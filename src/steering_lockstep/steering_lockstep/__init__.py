"""The lock-step contract carried over ROS: message layouts, topics and the node base class."""

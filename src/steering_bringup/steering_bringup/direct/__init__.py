"""The same cores as the ROS graph's, wired in one process without ROS."""

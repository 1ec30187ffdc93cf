"""ROS 2 node around :class:`stickslip.Tracker`."""

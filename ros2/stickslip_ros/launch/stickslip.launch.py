"""Starts the node, and RViz with its layout on request."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Returns the launch description."""
    share = FindPackageShare("stickslip_ros")
    parameters = PathJoinSubstitution([share, "config", "stickslip.yaml"])
    layout = PathJoinSubstitution([share, "rviz", "stickslip.rviz"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("params", default_value=parameters, description="file with the parameters"),
            DeclareLaunchArgument("rviz", default_value="false", description="true to start RViz"),
            DeclareLaunchArgument("fixed_frame", default_value="world", description="fixed frame of RViz: `frame`"),
            Node(
                package="stickslip_ros",
                executable="stickslip_node",
                name="stickslip",
                output="screen",
                parameters=[LaunchConfiguration("params")],
            ),
            Node(
                package="rviz2",
                executable="rviz2",
                arguments=["-d", layout, "-f", LaunchConfiguration("fixed_frame")],
                condition=IfCondition(LaunchConfiguration("rviz")),
            ),
        ]
    )

"""Installs the node for ``colcon build``."""

from setuptools import setup

NAME = "stickslip_ros"

setup(
    name=NAME,
    version="0.1.0",
    description="Tracks a pushed object through contact and occlusion: a node around stickslip.Tracker",
    license="MIT OR Apache-2.0",
    maintainer="stickslip contributors",
    maintainer_email="stickslip@example.org",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/stickslip_ros"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/config", ["config/stickslip.yaml"]),
        (f"share/{NAME}/launch", ["launch/stickslip.launch.py"]),
        (f"share/{NAME}/rviz", ["rviz/stickslip.rviz"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    entry_points={"console_scripts": ["stickslip_node = stickslip_ros.node:main"]},
)

"""
Runs culprit with a rule file.

    ros2 launch culprit_launch culprit.launch.py rules:=/etc/culprit/robot.rules arguments:="--web"
"""

import shlex

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.actions import OpaqueFunction
from launch.substitutions import LaunchConfiguration

from culprit_launch import RunCulprit


def run_culprit(context):
    arguments = LaunchConfiguration('arguments').perform(context)
    try:
        words = shlex.split(arguments)
    except ValueError as error:
        raise RuntimeError(f'arguments:={arguments} cannot be read: {error}') from error
    return [RunCulprit(rules=LaunchConfiguration('rules'), arguments=words)]


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('rules', description='The rule file that culprit runs with'),
        DeclareLaunchArgument(
            'arguments', default_value='',
            description='What else culprit run is to be given, as in a shell'),
        OpaqueFunction(function=run_culprit),
    ])

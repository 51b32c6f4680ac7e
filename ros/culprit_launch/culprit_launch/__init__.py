"""
Launch actions for robots that culprit looks after.

    from culprit_launch import ManagedNode, RunCulprit

    def generate_launch_description():
        rules = '/etc/culprit/robot.rules'
        return LaunchDescription([
            RunCulprit(rules=rules),
            ManagedNode(package='my_cameras', executable='driver', name='camera', rules=rules),
        ])
"""

from culprit_launch.managed_node import ManagedNode
from culprit_launch.run_culprit import RunCulprit

__all__ = ['ManagedNode', 'RunCulprit']

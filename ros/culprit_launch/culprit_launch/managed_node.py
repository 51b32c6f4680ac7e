"""A node that launch starts and culprit heals."""

import os

from launch.actions import Shutdown
from launch.utilities import normalize_to_list_of_substitutions
from launch.utilities import perform_substitutions
from launch_ros.actions import Node

from culprit_launch import program


def _shuts_down(on_exit):
    actions = on_exit if isinstance(on_exit, (list, tuple)) else [on_exit]
    return any(isinstance(action, Shutdown) for action in actions)


class ManagedNode(Node):
    """
    A node of a launch file that culprit looks after: launch starts it, culprit says when.

    - launch starts it again whenever it ends (`respawn`), so it stays launch's child: its output
      and its end with Ctrl-C are as those of any other node.
    - culprit ends it when its rules say that a redeploy helps, and waits until launch has started
      it again: its component is RESPAWNED. It is never started twice.
    - Before it starts, the rule file is looked at. If culprit would not heal the node by it, or
      would start it, too, the launch fails and says what to write.
    """

    def __init__(self, *, rules, name, respawn=True, on_exit=None, **kwargs):
        """
        Create the action. All that it does not name is as launch_ros.actions.Node has it.

        :param rules: the rule file that culprit runs with
        :param name: the node's name, by which culprit knows it
        """
        if respawn is not True:
            raise ValueError(
                'a ManagedNode is always started again (respawn=True), for culprit relies on that;'
                ' a node that is not, is a launch_ros.actions.Node')
        if _shuts_down(on_exit):
            raise ValueError(
                'on_exit=Shutdown() of a ManagedNode would end the robot whenever culprit repairs'
                ' the node: leave it out')
        super().__init__(name=name, respawn=True, on_exit=on_exit, **kwargs)
        self._rules = normalize_to_list_of_substitutions(rules)

    def execute(self, context):
        self._perform_substitutions(context)
        rules = os.path.abspath(os.path.expanduser(perform_substitutions(context, self._rules)))
        # A node without a namespace has that of the root.
        node = self.node_name.replace(self.UNSPECIFIED_NODE_NAMESPACE, '')
        why_not = program.why_not_healed(program.find(), rules, node)
        if why_not is not None:
            raise RuntimeError(why_not)
        return super().execute(context)

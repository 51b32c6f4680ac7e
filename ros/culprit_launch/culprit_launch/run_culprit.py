"""Culprit beside the nodes of a launch file."""

import os
import time

import launch.logging
from launch.action import Action
from launch.actions import ExecuteProcess
from launch.actions import TimerAction
from launch.utilities import normalize_to_list_of_substitutions
from launch.utilities import perform_substitutions

from culprit_launch import program

# As culprit's unit of systemd: after a second, and five times a minute at most.
RESTART_AFTER_S = 1.0
STARTS = 5
WITHIN_S = 60.0
# The exit status of a program of culprit's that was asked for something it cannot be asked for.
WRONG_USAGE = 2


class RunCulprit(Action):
    """
    Runs `culprit run` with a rule file until launch ends.

    - Before that `culprit check` looks at the rules. If they have errors, or culprit is not
      installed, the launch fails with what is wrong, where, and what to do: nobody should take a
      robot for looked after that is not.
    - If culprit ends it is started again a second later, whatever its exit status: it goes on
      where it was. Not if it was called with options that it has not, and not once it ended five
      times within a minute. The nodes run on in any case.
    - When launch ends, culprit ends, too, and leaves alone what ends then.
    """

    def __init__(self, *, rules, arguments=(), **kwargs):
        """
        Create the action.

        :param rules: the rule file
        :param arguments: what else `culprit run` is to be given, as ['--web', '--settle', '10s']
        """
        super().__init__(**kwargs)
        self._rules = normalize_to_list_of_substitutions(rules)
        self._arguments = [normalize_to_list_of_substitutions(one) for one in arguments]
        self._logger = launch.logging.get_logger('culprit')
        self._command = []
        self._starts = []

    def execute(self, context):
        rules = os.path.abspath(os.path.expanduser(perform_substitutions(context, self._rules)))
        culprit = program.find()
        program.check(culprit, rules)
        self._command = [culprit, 'run', rules]
        self._command += [perform_substitutions(context, one) for one in self._arguments]
        return [self._process()]

    def _process(self):
        self._starts = self._starts[-(STARTS - 1):] + [time.monotonic()]
        return ExecuteProcess(
            cmd=self._command, name='culprit', output='screen', on_exit=self._on_exit)

    def _on_exit(self, event, context):
        if context.is_shutdown:
            return None
        if event.returncode == WRONG_USAGE:
            self._logger.error(
                'culprit cannot run as it was asked to (it said why) and is not started again;'
                ' the nodes run on without it')
            return None
        if len(self._starts) == STARTS and time.monotonic() - self._starts[0] < WITHIN_S:
            self._logger.error(
                f'culprit ended {STARTS} times within {WITHIN_S:.0f} s and is not started again;'
                ' the nodes run on without it')
            return None
        return [TimerAction(period=RESTART_AFTER_S, actions=[self._process()])]

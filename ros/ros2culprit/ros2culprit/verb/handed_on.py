"""
The verbs of `ros2 culprit`: each is the command of that name of the culprit program.

The program has the options, the help and the exit status. It takes this process's place, so that
signals and the terminal are its own.
"""

import argparse
import os
import shutil
import sys

from ros2culprit.verb import VerbExtension

# The exit status of a shell for a command that is not there.
NOT_FOUND = 127
NOT_INSTALLED = (
    "ros2 culprit: there is no program 'culprit' on the PATH, which answers this. Install the"
    " package culprit (apt install ./culprit_*.deb) or build it in this workspace, and source its"
    ' setup file')


class HandedOn(VerbExtension):
    """Hands its arguments to the command of its name of the culprit program."""

    def add_arguments(self, parser, cli_name):
        # Whatever follows the verb is the program's, also -h and what else begins with a dash.
        parser.prefix_chars = '\0'
        parser.add_argument('arguments', nargs=argparse.REMAINDER)

    def main(self, *, args):
        program = shutil.which('culprit')
        if program is None:
            print(NOT_INSTALLED, file=sys.stderr)
            return NOT_FOUND
        sys.stdout.flush()
        sys.stderr.flush()
        os.execv(program, [program, self.NAME] + args.arguments)


class StatusVerb(HandedOn):
    """Say who is ill, who is blamed and what happens next."""


class DoctorVerb(HandedOn):
    """Say what is wrong with the robot, without rules; changes nothing."""


class ExplainVerb(HandedOn):
    """Explain a decision, or a code of culprit check and doctor."""

"""The command `ros2 culprit`."""

from ros2cli.command import add_subparsers_on_demand
from ros2cli.command import CommandExtension


class CulpritCommand(CommandExtension):
    """Ask culprit what is wrong with the robot."""

    def add_arguments(self, parser, cli_name):
        self._subparser = parser
        add_subparsers_on_demand(parser, cli_name, '_verb', 'ros2culprit.verb', required=False)

    def main(self, *, parser, args):
        if not hasattr(args, '_verb'):
            self._subparser.print_help()
            return 0
        return args._verb.main(args=args)

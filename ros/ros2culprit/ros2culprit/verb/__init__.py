"""What a verb of `ros2 culprit` is."""

from ros2cli.plugin_system import PLUGIN_SYSTEM_VERSION
from ros2cli.plugin_system import satisfies_version


class VerbExtension:
    """
    The extension point of the verbs of `ros2 culprit`.

    A verb has a NAME (that of its entry point), `main`, and `add_arguments` if it takes any.
    """

    NAME = None
    EXTENSION_POINT_VERSION = '0.1'

    def __init__(self):
        super().__init__()
        satisfies_version(PLUGIN_SYSTEM_VERSION, '^0.1')

    def main(self, *, args):
        raise NotImplementedError()

"""What the tests share: stand-ins for programs, and a launch that ends when told so."""

import logging
import os
import time

from launch import LaunchDescription
from launch import LaunchService
from launch.actions import OpaqueFunction
from launch.actions import Shutdown
from launch.actions import TimerAction
import pytest

PATIENCE_S = 60


@pytest.fixture
def program(tmp_path, monkeypatch):
    """Put a shell script on the PATH, before all else."""
    folder = tmp_path / 'bin'
    folder.mkdir()
    monkeypatch.setenv('PATH', f'{folder}{os.pathsep}{os.environ["PATH"]}')

    def put(name, script):
        file = folder / name
        file.write_text(f'#!/bin/sh\n{script}\n')
        file.chmod(0o755)
        return str(file)

    return put


@pytest.fixture
def log():
    """Give a function that gives what launch and its actions have logged."""
    class Words(logging.Handler):
        said = ''

        def emit(self, record):
            self.said += record.getMessage() + '\n'

    words = Words()
    loggers = [logging.getLogger(name) for name in ('launch', 'culprit')]
    for logger in loggers:
        logger.addHandler(words)
    yield lambda: words.said
    for logger in loggers:
        logger.removeHandler(words)


@pytest.fixture
def run():
    """Run launch actions until `until()` is true, or launch ends. Gives its exit code."""

    def run_until(actions, until):
        give_up = time.monotonic() + PATIENCE_S

        def look(context):
            if until():
                return [Shutdown(reason='the test has seen what it waits for')]
            assert time.monotonic() < give_up, 'what the test waits for does not happen'
            return [TimerAction(period=0.05, actions=[OpaqueFunction(function=look)])]

        service = LaunchService()
        service.include_launch_description(
            LaunchDescription([*actions, OpaqueFunction(function=look)]))
        return service.run()

    return run_until

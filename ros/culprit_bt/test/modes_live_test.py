"""
RequestMode beside the `culprit modes` that runs: the mode of a node really changes.

As in live_test.py, the program `culprit` is found on the PATH, and without it these tests are
skipped. MISSION and BASE are what the build gives.
"""

import os
import shutil
import signal

from live_test import Process

import pytest

pytestmark = pytest.mark.skipif(
    shutil.which('culprit') is None, reason='culprit is not installed')

MODEL = """
drive:
  ros__parameters:
    type: system
    parts: drive_base
    modes:
      __DEFAULT__: {drive_base: active.__DEFAULT__}
      SLOW: {drive_base: active.SLOW}
      RACE: {drive_base: active.RACE}
      STAND: {drive_base: inactive}
drive_base:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {max_speed: 1.0}}
      SLOW: {ros__parameters: {max_speed: 0.2}}
      RACE: {ros__parameters: {max_speed: 9.0}}
"""

TREE = """
<root BTCPP_format="4">
  <BehaviorTree ID="Mission">
    <Fallback>
      <Sequence>{leaves}</Sequence>
      <ForceFailure><Stop why="{{reason}}"/></ForceFailure>
    </Fallback>
  </BehaviorTree>
</root>
"""


@pytest.fixture
def processes(monkeypatch):
    monkeypatch.setenv('ROS_LOCALHOST_ONLY', '1')
    monkeypatch.setenv('ROS_DOMAIN_ID', '64')
    monkeypatch.setenv('PYTHONUNBUFFERED', '1')
    started = []

    def start(*command):
        started.append(Process(*command))
        return started[-1]

    yield start
    for one in reversed(started):
        one.end()


@pytest.fixture
def base(processes):
    base = processes(os.environ['BASE'])
    base.waits_for('^configured$')
    return base


@pytest.fixture
def modes(processes, tmp_path):
    """Give how `culprit modes` is started."""
    model = tmp_path / 'modes.yaml'
    model.write_text(MODEL)

    def start():
        manager = processes('culprit', 'modes', str(model))
        manager.waits_for('serves 2 systems and nodes')
        return manager

    return start


@pytest.fixture
def mission(processes, tmp_path):
    """Give how a mission of these leaves is started."""
    tree = tmp_path / 'mission.xml'

    def start(*requests):
        leaves = ''.join(
            f'<RequestMode system="{system}" mode="{mode}" timeout="{timeout}" reason="{{reason}}"/>'
            for system, mode, timeout in requests)
        tree.write_text(TREE.format(leaves=leaves))
        return processes(os.environ['MISSION'], str(tree))

    return start


def test_a_system_gets_into_the_modes_one_after_the_other(base, modes, mission):
    manager = modes()
    asks = mission(('drive', 'SLOW', 60), ('drive', 'STAND', 60), ('/drive', '__DEFAULT__', 60))
    assert asks.ends() == 0, asks.lines
    assert asks.lines[-1] == 'the mission SUCCESS'
    base.waits_for('^active$', 2)
    base.waits_for('^inactive$')
    base.waits_for('^max_speed 1.000000$')
    assert base.lines.index('max_speed 0.200000') < base.lines.index('inactive')
    assert base.lines.index('inactive') < base.lines.index('max_speed 1.000000')
    manager.waits_for('^/drive .*-> active.SLOW')
    manager.waits_for('^/drive .*-> active.__DEFAULT__')


def test_a_node_gets_into_a_mode_without_a_system(base, modes, mission):
    modes()
    asks = mission(('drive_base', 'SLOW', 60))
    assert asks.ends() == 0, asks.lines
    base.waits_for('^max_speed 0.200000$')


def test_it_waits_for_whoever_serves_the_modes(base, modes, mission):
    asks = mission(('drive', 'SLOW', 60))
    modes()
    assert asks.ends() == 0, asks.lines
    base.waits_for('^max_speed 0.200000$')


def test_a_mode_that_the_node_refuses_fails_with_the_one_it_is_in(base, modes, mission):
    manager = modes()
    asks = mission(('drive', 'SLOW', 60), ('drive', 'RACE', 5))
    assert asks.ends() == 1
    base.waits_for('^refuses 9.000000$')
    (why,) = [line for line in asks.lines if line.startswith('stopped: ')]
    assert why == "stopped: mode 'RACE' was accepted, and /drive is in 'SLOW'"
    manager.waits_for('/drive_base were not set: it refused, it cannot go as fast')


def test_a_mode_that_the_model_has_not_is_refused(base, modes, mission):
    modes()
    asks = mission(('drive', 'SLOW', 60), ('drive', 'SLWO', 60))
    assert asks.ends() == 1
    assert any("/drive refused mode 'SLWO'" in line for line in asks.lines)


def test_it_fails_in_its_time_where_the_node_is_not_there(modes, mission):
    modes()
    asks = mission(('drive', 'SLOW', 3))
    assert asks.ends() == 1
    assert any(line.startswith("stopped: mode 'SLOW' was accepted, and /drive is in ")
               for line in asks.lines), asks.lines


def test_it_fails_in_its_time_where_the_manager_is_killed_meanwhile(base, modes, mission):
    manager = modes()
    base.process.send_signal(signal.SIGSTOP)
    asks = mission(('drive', 'SLOW', 15))
    manager.waits_for('/drive_base was not activated: it did not answer')
    manager.process.kill()
    assert asks.ends() == 1
    assert any(line.startswith("stopped: mode 'SLOW' was accepted, and ")
               for line in asks.lines), asks.lines

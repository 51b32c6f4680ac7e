"""
A mission beside a culprit that runs: it stands while a node is being repaired, and then goes on.

The program `culprit` is found on the PATH; without it these tests are skipped. MISSION, DRIVER and
TREES are what the build gives.
"""

import os
import re
import shutil
import signal
import subprocess
import threading
import time

import pytest

PATIENCE_S = 100

pytestmark = pytest.mark.skipif(
    shutil.which('culprit') is None, reason='culprit is not installed')

RULES = """
COMPONENT camera NODE /camera LAUNCH "{driver}" REQUIRED
RULE CameraSilent
  POLICIES ERROR FOR 200ms
  TRIGGER age(/beat) > 1s
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
"""


class Process:
    """A process, and what it has printed."""

    def __init__(self, *command, **environment):
        self.lines = []
        self.process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, errors='replace', env={**os.environ, **environment})
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.append(line.rstrip())

    def waits_for(self, pattern, count=1):
        """Wait until so many lines match."""
        give_up = time.monotonic() + PATIENCE_S
        while sum(1 for line in list(self.lines) if re.search(pattern, line)) < count:
            assert time.monotonic() < give_up, f'no {pattern!r} in:\n' + '\n'.join(self.lines)
            time.sleep(0.02)

    def ends(self):
        status = self.process.wait(PATIENCE_S)
        self._reader.join(PATIENCE_S)
        return status

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGCONT)
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.wait(20)
            except subprocess.TimeoutExpired:
                self.process.kill()


@pytest.fixture
def alone(monkeypatch):
    monkeypatch.setenv('ROS_LOCALHOST_ONLY', '1')
    monkeypatch.setenv('ROS_DOMAIN_ID', '74')
    monkeypatch.setenv('PYTHONUNBUFFERED', '1')


@pytest.fixture
def processes(alone):
    started = []

    def start(*command):
        started.append(Process(*command))
        return started[-1]

    yield start
    for one in reversed(started):
        one.end()


def drivers():
    """Give the processes of the robot's node."""
    driver = os.path.realpath(os.environ['DRIVER'])
    found = []
    for pid in filter(str.isdigit, os.listdir('/proc')):
        try:
            if os.readlink(f'/proc/{pid}/exe') == driver:
                found.append(int(pid))
        except OSError:
            pass  # It has just ended, or is somebody else's.
    return found


@pytest.fixture
def robot(processes, tmp_path):
    """Start culprit, which starts the robot's node; give culprit."""
    rules = tmp_path / 'robot.rules'
    rules.write_text(RULES.format(driver=os.environ['DRIVER']))

    def start():
        return processes(
            'culprit', 'run', str(rules), '--launch', '--state-dir', str(tmp_path / 'state'),
            '--backoff', '100ms')

    yield start
    for pid in drivers():
        os.kill(pid, signal.SIGKILL)


def mission(processes, seconds=3):
    tree = os.path.join(os.environ['TREES'], 'stop_while_repaired.xml')
    return processes(os.environ['MISSION'], tree, 'component=camera', f'seconds={seconds}')


def test_it_stands_while_the_node_is_repaired_and_goes_on(processes, robot):
    robot()
    drives = mission(processes, seconds=60)
    drives.waits_for('^drives$')
    for kill in range(3):
        (pid,) = drivers()
        os.kill(pid, signal.SIGKILL)
        drives.waits_for('^stands$', kill + 1)
        drives.waits_for('^stopped: .*camera', kill + 1)
        drives.waits_for('^drives on$', kill + 1)
        assert pid not in drivers()
    assert drives.process.poll() is None


def test_it_reaches_its_end_and_says_so(processes, robot):
    robot()
    drives = mission(processes, seconds=1)
    assert drives.ends() == 0
    assert drives.lines[-2:] == ['is there', 'the mission SUCCESS']


def test_it_stands_while_culprit_is_stopped_or_killed_and_goes_on_with_the_next(processes, robot):
    culprit = robot()
    drives = mission(processes, seconds=60)
    drives.waits_for('^drives$')
    culprit.process.send_signal(signal.SIGSTOP)
    drives.waits_for('^stands$')
    drives.waits_for('^stopped: .*does not answer')
    culprit.process.send_signal(signal.SIGCONT)
    drives.waits_for('^drives on$')
    culprit.process.kill()
    culprit.ends()
    drives.waits_for('^stands$', 2)
    robot()
    drives.waits_for('^drives on$', 2)


def test_without_culprit_it_never_drives_and_fails(processes):
    drives = mission(processes)
    assert drives.ends() == 1
    assert 'drives' not in drives.lines
    assert any('does `culprit run` run?' in line for line in drives.lines)


def test_a_tree_of_the_working_folder_is_read_by_its_name(alone, tmp_path):
    (tmp_path / 'my.xml').write_text(
        '<root BTCPP_format="4"><BehaviorTree ID="M"><AlwaysSuccess/></BehaviorTree></root>')
    ran = subprocess.run(
        [os.environ['MISSION'], 'my.xml'], cwd=tmp_path, capture_output=True, text=True,
        timeout=PATIENCE_S)
    assert ran.stdout.splitlines()[-1:] == ['the mission SUCCESS'], ran.stderr


def test_a_mistyped_component_fails_the_mission(processes, robot):
    robot()
    tree = os.path.join(os.environ['TREES'], 'stop_while_repaired.xml')
    drives = processes(os.environ['MISSION'], tree, 'component=camra', 'seconds=3')
    assert drives.ends() == 1
    assert 'drives' not in drives.lines
    assert any("did you mean 'camera'?" in line for line in drives.lines)

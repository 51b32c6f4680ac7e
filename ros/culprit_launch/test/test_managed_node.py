"""Nodes that launch starts and culprit heals: no fight over who starts them."""

import json
import shutil

from culprit_launch import ManagedNode
from culprit_launch import program as culprit_program
from launch.actions import Shutdown
from launch_ros.actions import PushRosNamespace
import pytest

needs_culprit = pytest.mark.skipif(
    shutil.which('culprit') is None, reason='culprit is not installed')


@pytest.fixture(autouse=True)
def forgets_files():
    culprit_program._statements.cache_clear()


@pytest.fixture
def exports(program):
    """Let `culprit export` answer with these components."""

    def put(*components):
        statements = [{'statement': 'COMPONENT', **one} for one in components]
        answer = json.dumps({'version': 1, 'statements': statements})
        return program('culprit', f"cat <<'EOF'\n{answer}\nEOF")

    return put


def starts(file):
    return file.read_text().splitlines() if file.exists() else []


def test_a_node_that_ends_is_started_again_until_launch_ends(exports, program, run, tmp_path):
    exports({'name': 'camera', 'node': '/camera', 'respawned': True})
    said = tmp_path / 'said'
    driver = program(
        'driver', f'echo "$@" >> {said}; test $(wc -l < {said}) = 3 && exec sleep 1000; exit 1')
    node = ManagedNode(executable=driver, name='camera', rules='my.rules')
    assert run([node], lambda: len(starts(said)) == 3) == 0
    assert starts(said) == ['--ros-args -r __node:=camera'] * 3


def test_it_is_known_by_its_full_name(exports, program, run, tmp_path):
    exports({'name': 'camera', 'node': '/left/camera', 'respawned': True})
    said = tmp_path / 'said'
    driver = program('driver', f'echo x >> {said}; exec sleep 1000')
    node = ManagedNode(executable=driver, name='camera', rules='my.rules')
    assert run([PushRosNamespace('left'), node], lambda: starts(said)) == 0


@pytest.mark.parametrize('owner, words', [
    ({'launch': 'driver'}, 'started twice, by this launch file and by the LAUNCH'),
    ({'unit': 'camera.service'}, 'started twice, by this launch file and by the UNIT'),
    ({}, 'does not say who starts /camera again'),
])
def test_it_is_not_started_where_another_would_or_nobody(
        exports, program, run, tmp_path, log, owner, words):
    exports({'name': 'camera', 'node': '/camera', **owner})
    said = tmp_path / 'said'
    driver = program('driver', f'echo x >> {said}')
    node = ManagedNode(executable=driver, name='camera', rules='my.rules')
    assert run([node], lambda: False) == 1
    out = log()
    assert words in out and 'RESPAWNED' in out
    assert not starts(said)


def test_a_mistyped_name_is_told_with_the_one_that_was_meant(exports, program, run, log):
    exports({'name': 'camera', 'node': '/camera', 'respawned': True})
    node = ManagedNode(executable=program('driver', ''), name='camra', rules='my.rules')
    assert run([node], lambda: False) == 1
    out = log()
    assert 'no component' in out and 'did you mean /camera?' in out


def test_what_is_to_be_added_has_a_name_of_its_own(exports):
    culprit = exports({'name': 'camera', 'node': '/right/camera', 'respawned': True})
    why_not = culprit_program.why_not_healed(culprit, 'my.rules', '/left/camera')
    assert why_not.endswith('add COMPONENT left_camera NODE /left/camera RESPAWNED')


def test_a_node_without_a_namespace_may_be_named_by_the_component(exports):
    culprit = exports({'name': 'camera', 'respawned': True})
    assert culprit_program.why_not_healed(culprit, 'my.rules', '/left/camera') is None


def test_what_ends_the_robot_when_the_node_ends_is_refused():
    with pytest.raises(ValueError, match='Shutdown'):
        ManagedNode(executable='driver', name='camera', rules='my.rules', on_exit=Shutdown())
    with pytest.raises(ValueError, match='Shutdown'):
        ManagedNode(executable='driver', name='camera', rules='my.rules', on_exit=[Shutdown()])


def test_a_node_that_is_not_started_again_is_refused():
    with pytest.raises(ValueError, match='respawn=True'):
        ManagedNode(executable='driver', name='camera', rules='my.rules', respawn=False)


@needs_culprit
def test_the_program_itself_says_what_included_files_declare(tmp_path):
    (tmp_path / 'inner.rules').write_text('COMPONENT lidar NODE /lidar LAUNCH "driver"\n')
    rules = tmp_path / 'my.rules'
    rules.write_text('INCLUDE "inner.rules"\nCOMPONENT camera NODE /camera RESPAWNED\n')
    culprit = culprit_program.find()
    assert culprit_program.why_not_healed(culprit, str(rules), '/camera') is None
    assert 'inner.rules' in culprit_program.why_not_healed(culprit, str(rules), '/lidar')
    assert 'no component' in culprit_program.why_not_healed(culprit, str(rules), '/arm')


@needs_culprit
def test_what_templates_put_in_is_not_complained_of(tmp_path):
    rules = tmp_path / 'my.rules'
    rules.write_text(
        'TEMPLATE driver(name)\nCOMPONENT {name} NODE /{name} RESPAWNED\nEND\n'
        'USE driver(camera)\n')
    assert culprit_program.why_not_healed(culprit_program.find(), str(rules), '/camera') is None


@needs_culprit
def test_rules_that_cannot_be_read_are_told(tmp_path):
    rules = tmp_path / 'my.rules'
    rules.write_text('COMPONNT camera\n')
    with pytest.raises(RuntimeError, match=r'my\.rules:1:1'):
        culprit_program.why_not_healed(culprit_program.find(), str(rules), '/camera')

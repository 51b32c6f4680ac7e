"""Culprit beside nodes: when it is started, again, or not at all; and what is said then."""

from pathlib import Path
import shutil

from culprit_launch import run_culprit
from culprit_launch import RunCulprit
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
import pytest

WELL = 'test "$1" = run || exit 0\n'


@pytest.fixture(autouse=True)
def soon(monkeypatch):
    monkeypatch.setattr(run_culprit, 'RESTART_AFTER_S', 0.01)


def starts(file):
    return file.read_text().splitlines() if file.exists() else []


def test_runs_culprit_with_its_rules_and_arguments(program, run, tmp_path):
    said = tmp_path / 'said'
    program('culprit', f'{WELL} echo "$@" >> {said}; exec sleep 1000')
    rules = tmp_path / 'my.rules'
    action = RunCulprit(rules=str(rules), arguments=['--settle', '10s'])
    assert run([action], lambda: starts(said)) == 0
    assert starts(said) == [f'run {rules} --settle 10s']


def test_rules_beside_the_launch_are_named_wholly(program, run, tmp_path, monkeypatch):
    said = tmp_path / 'said'
    program('culprit', f'{WELL} echo "$2" >> {said}; exec sleep 1000')
    monkeypatch.chdir(tmp_path)
    run([RunCulprit(rules='my.rules')], lambda: starts(said))
    assert starts(said) == [str(tmp_path / 'my.rules')]


@pytest.mark.parametrize('end', ['exit 0', 'exit 1', 'kill -KILL $$'])
def test_is_started_again_when_it_ended(program, run, tmp_path, end):
    said = tmp_path / 'said'
    program(
        'culprit',
        f'{WELL} echo x >> {said}; test $(wc -l < {said}) = 2 && exec sleep 1000; {end}')
    assert run([RunCulprit(rules='my.rules')], lambda: len(starts(said)) == 2) == 0


def test_is_not_started_again_where_it_was_called_wrongly(program, run, tmp_path, log):
    said = tmp_path / 'said'
    program('culprit', f'{WELL} echo x >> {said}; exit 2')
    run([RunCulprit(rules='my.rules', arguments=['--nonsense'])], lambda: 'started again' in log())
    assert len(starts(said)) == 1
    assert 'is not started again' in log()


def test_gives_up_when_it_ends_again_and_again(program, run, tmp_path, log):
    said = tmp_path / 'said'
    program('culprit', f'{WELL} echo x >> {said}; exit 1')
    run([RunCulprit(rules='my.rules')], lambda: 'started again' in log())
    assert len(starts(said)) == run_culprit.STARTS
    assert 'ended 5 times within 60 s' in log()


def test_rules_with_errors_fail_the_launch_with_what_check_says(program, run, tmp_path, log):
    said = tmp_path / 'said'
    complains = '{ echo "my.rules:1:6: error[R006]" >&2; exit 1; }'
    program('culprit', f'test $1 = check && {complains}; echo x >> {said}')
    assert run([RunCulprit(rules='my.rules')], lambda: False) == 1
    assert 'my.rules:1:6: error[R006]' in log()
    assert not starts(said)


def test_without_the_program_the_launch_fails_and_says_what_to_install(run, log, monkeypatch):
    monkeypatch.setenv('PATH', '/nowhere')
    assert run([RunCulprit(rules='my.rules')], lambda: False) == 1
    out = log()
    assert "no program 'culprit' on the PATH" in out and 'apt install' in out


def test_the_launch_file_gives_its_arguments_on_as_a_shell_would(program, run, tmp_path):
    said = tmp_path / 'said'
    program('culprit', f'{WELL} printf "<%s>" "$@" >> {said}; exec sleep 1000')
    file = Path(__file__).parent.parent / 'launch' / 'culprit.launch.py'
    arguments = {'rules': '/a/my.rules', 'arguments': '--node-name "two words" --web'}
    included = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(str(file)), launch_arguments=arguments.items())
    assert run([included], lambda: said.exists() and said.read_text().endswith('<--web>')) == 0
    assert said.read_text() == '<run></a/my.rules><--node-name><two words><--web>'


def test_the_launch_file_says_that_a_quote_is_open(run, log):
    file = Path(__file__).parent.parent / 'launch' / 'culprit.launch.py'
    arguments = {'rules': '/a/my.rules', 'arguments': '--node-name "two'}
    included = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(str(file)), launch_arguments=arguments.items())
    assert run([included], lambda: False) == 1
    assert 'No closing quotation' in log()


@pytest.mark.skipif(shutil.which('culprit') is None, reason='culprit is not installed')
def test_the_program_itself_refuses_rules_with_errors(run, tmp_path, log):
    rules = tmp_path / 'my.rules'
    rules.write_text('RULE CameraGone\n')
    assert run([RunCulprit(rules=str(rules))], lambda: False) == 1
    assert f'{rules}:1:6: error[R006]' in log()

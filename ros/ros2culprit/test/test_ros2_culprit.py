"""What `ros2 culprit` hands on, and what it says where there is nobody to hand it to."""

import os
import subprocess
import sys

import pytest


def ros2(*arguments, path):
    """Run `ros2` where programs are looked for in `path` only."""
    return subprocess.run(
        [sys.executable, '-c', 'import sys; from ros2cli.cli import main; sys.exit(main())',
         *arguments],
        env={**os.environ, 'PATH': str(path)}, capture_output=True, text=True)


@pytest.fixture
def program(tmp_path):
    """Put a program of the name culprit there that says how it was called, and ends with 3."""
    file = tmp_path / 'culprit'
    file.write_text('#!/bin/sh\nprintf "<%s>" "$@"\nexit 3\n')
    file.chmod(0o755)
    return tmp_path


@pytest.mark.parametrize('verb', ['status', 'doctor', 'explain'])
def test_hands_on_arguments_and_exit_status(program, verb):
    ran = ros2('culprit', verb, '--json', '-h', 'two words', '--', '-1', path=program)
    assert ran.stdout == f'<{verb}><--json><-h><two words><--><-1>', ran.stderr
    assert ran.returncode == 3


def test_a_verb_needs_no_arguments(program):
    assert ros2('culprit', 'status', path=program).stdout == '<status>'


def test_a_program_that_is_killed_ends_the_command_as_it_ended(tmp_path):
    file = tmp_path / 'culprit'
    file.write_text('#!/bin/sh\nkill -KILL $$\n')
    file.chmod(0o755)
    assert ros2('culprit', 'doctor', path=tmp_path).returncode == -9


def test_says_what_to_install_where_there_is_no_program(tmp_path):
    ran = ros2('culprit', 'status', path=tmp_path)
    assert ran.returncode == 127
    assert "no program 'culprit' on the PATH" in ran.stderr
    assert 'apt install' in ran.stderr
    assert len(ran.stderr.splitlines()) == 1


def test_a_program_that_is_no_program_is_not_run(tmp_path):
    (tmp_path / 'culprit').write_text('no program')
    assert ros2('culprit', 'status', path=tmp_path).returncode == 127


def test_without_a_verb_it_lists_them(tmp_path):
    ran = ros2('culprit', path=tmp_path)
    assert ran.returncode == 0
    for verb in ('status', 'doctor', 'explain'):
        assert verb in ran.stdout


def test_a_mistyped_verb_is_refused(program):
    ran = ros2('culprit', 'statsu', path=program)
    assert ran.returncode == 2
    assert 'statsu' in ran.stderr

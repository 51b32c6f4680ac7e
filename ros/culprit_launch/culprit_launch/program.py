"""The culprit program: where it is, and what it says of a rule file."""

import difflib
import functools
import json
import os
import shutil
import subprocess

INSTALL = (
    'install the package culprit (apt install ./culprit_*.deb) or build it in this workspace, and'
    ' source its setup file')
# Looking at a rule file takes a fraction of a second.
PATIENCE_S = 60


def find():
    """Give the path of the program. Raises RuntimeError, with the remedy, if there is none."""
    program = shutil.which('culprit')
    if program is None:
        raise RuntimeError(f"there is no program 'culprit' on the PATH: {INSTALL}")
    return program


def _ask(program, *arguments):
    try:
        return subprocess.run(
            [program, *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True,
            errors='replace', timeout=PATIENCE_S)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise RuntimeError(f'{program} does not answer: {error}') from error


def check(program, rules):
    """
    Ask `culprit check` about the rule file. Raises RuntimeError with all that it says of errors.

    What it warns of, `culprit run` says itself.
    """
    checked = _ask(program, 'check', rules)
    if checked.returncode != 0:
        said = (checked.stderr + checked.stdout).strip()
        raise RuntimeError(f'culprit is not started, for its rules have errors:\n{said}')


@functools.lru_cache(maxsize=64)
def _statements(program, rules):
    """Give the statements of a rule file, and of those that it includes and that are beside it."""
    exported = _ask(program, 'export', '--json', rules)
    if exported.returncode != 0:
        raise RuntimeError(
            f'the rules cannot be read:\n{(exported.stderr + exported.stdout).strip()}')
    return json.loads(exported.stdout)['statements']


def _components(program, rules, seen):
    """Give (node, statement, file) of each COMPONENT, and whether there may be others."""
    seen.add(rules)
    found, is_all = [], True
    in_template = False
    for statement in _statements(program, rules):
        kind = statement['statement']
        if kind == 'TEMPLATE':
            in_template = True
        elif kind == 'END':
            in_template = False
        elif kind == 'USE':
            is_all = False  # culprit puts in the parameters of a template.
        elif kind == 'INCLUDE':
            file = os.path.normpath(os.path.join(os.path.dirname(rules), statement['file']))
            if not os.path.isfile(file):
                is_all = False  # One of those that come along with culprit.
            elif file not in seen:
                included, is_all_of_it = _components(program, file, seen)
                found += included
                is_all = is_all and is_all_of_it
        elif kind == 'COMPONENT' and not in_template:
            found.append((statement.get('node'), statement, rules))
    return found, is_all


def why_not_healed(program, rules, node):
    """
    Give why culprit, by this rule file, would not heal a node that launch starts again, or None.

    `node` is its full name. Components that templates put in are ignored, without a complaint.
    """
    components, is_all = _components(program, rules, set())
    own_name = node.rsplit('/', 1)[-1]
    for full_name, component, file in components:
        if full_name != node and not (full_name is None and component['name'] == own_name):
            continue
        if component.get('respawned'):
            return None
        starter = next(
            (word for word in ('launch', 'unit', 'container', 'in') if word in component), None)
        if starter is None:
            return (
                f"component '{component['name']}' of {file} does not say who starts {node} again,"
                ' so culprit never ends it when it hangs: write RESPAWNED behind it')
        return (
            f"{node} would be started twice, by this launch file and by the {starter.upper()} of"
            f" component '{component['name']}' in {file}: write RESPAWNED in its place, or take"
            ' the node out of the launch file')
    if not is_all:
        return None
    names = [full_name or component['name'] for full_name, component, _ in components]
    near = difflib.get_close_matches(node, names, n=1)
    meant = f' (did you mean {near[0]}?)' if near else ''
    # Where another component has the node's own name, its full name makes one of its own.
    is_taken = any(component['name'] == own_name for _, component, _ in components)
    name = node.strip('/').replace('/', '_') if is_taken else own_name
    return (
        f'no component of {rules} is {node}{meant}, so culprit does not look after it: add'
        f' COMPONENT {name} NODE {node} RESPAWNED')

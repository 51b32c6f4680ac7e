#!/usr/bin/env python3
"""Scores answers to the cases of culprit's root-cause benchmark.

README.md beside this file documents cases and answers. The standard library of Python 3.8 is enough.
Exit codes: 0 scored, 2 wrong input (the message names the place).
"""

import argparse
import csv
import itertools
import json
import math
import os
import sys

MOST_BYTES = 64 << 20
REPAIRS = ("configure", "restart", "redeploy")
DAMPING = 0.85  # of PageRank
RECENT_S = 5.0  # failing: reported in at least half of the readings of the last 5 s
BRIDGED_S = 2.0  # shorter pauses do not end a failure (a flapping component is well for 1.5 s)
LEADS_S = (0.0, 1.0, 2.0, 3.0)  # how much later a signal may follow another one
CHUNK = 5  # of RCD, as its authors' code has it, like the levels of significance
CHUNK_ALPHAS = tuple(0.01 + 0.1 * i for i in range(10))
LAST_ALPHAS = tuple(0.001 + 0.1 * i for i in range(10))


class Problem(Exception):
    """Wrong input: where, and what is wrong."""

    def __init__(self, place, text):
        super().__init__(f"{place}: {text}")


# ---- reading


def read_text(path):
    try:
        with open(path, "rb") as file:
            data = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise Problem(path, error.strerror or "cannot be read") from error
    if len(data) > MOST_BYTES:
        raise Problem(path, f"is larger than {MOST_BYTES} bytes")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise Problem(path, "is not UTF-8") from error


def read_json(path):
    def members(pairs):
        found = {}
        for name, value in pairs:
            if name in found:
                raise ValueError(f"the member {shown(name)} is there twice")
            found[name] = value
        return found

    def constant(name):
        raise ValueError(f"{name} is no JSON number")

    try:
        return json.loads(read_text(path), object_pairs_hook=members, parse_constant=constant)
    except RecursionError as error:
        raise Problem(path, "is nested too deeply") from error
    except ValueError as error:
        raise Problem(path, f"is not JSON ({error})") from error


def shown(name):
    return repr(name[:40])


def expect(value, kind, place, what):
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        raise Problem(place, f"is not {what}")
    return value


def member(json_object, name, kind, place, what):
    if name not in json_object:
        raise Problem(place, f"has no '{name}'")
    return expect(json_object[name], kind, f"{place}/{name}", what)


def seconds(value, place):
    expect(value, (int, float), place, "a number")
    if not 0 <= value <= 1e6 or not math.isfinite(value):
        raise Problem(place, "is not a time in seconds from 0 to 1000000")
    return float(value)


def names(value, place, known):
    found = []
    for i, name in enumerate(expect(value, list, place, "a list of components")):
        expect(name, str, f"{place}/{i}", "the name of a component")
        if name not in known:
            raise Problem(f"{place}/{i}", f"there is no component {shown(name)}")
        if name in found:
            raise Problem(f"{place}/{i}", f"{shown(name)} is there twice")
        found.append(name)
    return found


class Case:
    """Graph and signals of one case."""

    def __init__(self, folder):
        path = os.path.join(folder, "graph.json")
        graph = expect(read_json(path), dict, path, "an object")
        self.components = []
        self.watched = []
        for i, entry in enumerate(member(graph, "components", list, path, "a list")):
            place = f"{path}/components/{i}"
            expect(entry, dict, place, "an object")
            name = member(entry, "name", str, place, "a name")
            if name in self.components:
                raise Problem(place, f"{shown(name)} is there twice")
            self.components.append(name)
            if member(entry, "watched", bool, place, "true or false"):
                self.watched.append(name)
        self.suppliers = {name: set() for name in self.components}
        for i, topic in enumerate(member(graph, "topics", list, path, "a list")):
            place = f"{path}/topics/{i}"
            expect(topic, dict, place, "an object")
            publishers = names(topic.get("publishers"), f"{place}/publishers", self.suppliers)
            subscribers = names(topic.get("subscribers"), f"{place}/subscribers", self.suppliers)
            if topic.get("ignored"):
                continue
            for subscriber in subscribers:
                self.suppliers[subscriber].update(p for p in publishers if p != subscriber)
        self.read_signals(os.path.join(folder, "signals.csv"))

    def read_signals(self, path):
        lines = read_text(path).splitlines()
        try:
            rows = list(csv.reader(lines))
        except csv.Error as error:
            raise Problem(path, f"is not CSV ({error})") from error
        if not rows or rows[0] != ["time_s", *self.watched]:
            raise Problem(f"{path}:1", "is not time_s and the watched components of graph.json")
        if len(rows) < 2:
            raise Problem(path, "has no readings")
        self.times = []
        self.signals = {name: [] for name in self.watched}
        for number, row in enumerate(rows[1:], 2):
            if len(row) != len(rows[0]) or any(value not in ("0", "1") for value in row[1:]):
                raise Problem(f"{path}:{number}", "is not a time and a 0 or 1 for each component")
            try:
                self.times.append(seconds(float(row[0]), f"{path}:{number}"))
            except ValueError as error:
                raise Problem(f"{path}:{number}", "does not begin with a time") from error
            for name, value in zip(self.watched, row[1:]):
                self.signals[name].append(int(value))

    def all_suppliers(self, name):
        """The components upstream of this one, itself left out."""
        found, pending = set(), [name]
        while pending:
            for supplier in self.suppliers[pending.pop()]:
                if supplier not in found:
                    found.add(supplier)
                    pending.append(supplier)
        return found - {name}

    def failing(self):
        """The components that fail at the end."""
        recent = [i for i, t in enumerate(self.times) if t > self.times[-1] - RECENT_S]
        return [c for c in self.watched if 2 * sum(self.signals[c][i] for i in recent) >= len(recent)]

    def onset(self, name):
        """When the failure began that lasts until the end; short pauses are bridged."""
        begin = self.times[-1]
        for time, value in zip(reversed(self.times), reversed(self.signals[name])):
            if value:
                begin = time
            elif begin - time > BRIDGED_S:
                break
        return begin


def read_cases(folder):
    try:
        found = sorted(entry for entry in os.listdir(folder) if entry.startswith("case-"))
    except OSError as error:
        raise Problem(folder, error.strerror or "cannot be read") from error
    if not found:
        raise Problem(folder, "has no folder case-*")
    return {name: Case(os.path.join(folder, name)) for name in found}


class Truth:
    def __init__(self, value, place, case):
        expect(value, dict, place, "an object")
        self.begins = {}  # by faulty component
        self.repairs = {}
        for i, cause in enumerate(member(value, "causes", list, place, "a list")):
            at = f"{place}/causes/{i}"
            expect(cause, dict, at, "an object")
            name = names([cause.get("component")], at, case.suppliers)[0]
            self.begins[name] = seconds(cause.get("at_s"), f"{at}/at_s")
            self.repairs[name] = member(cause, "repairs", list, at, "a list")
        if not self.begins:
            raise Problem(place, "has no cause")


def read_truths(folder, path, cases):
    if path is None:
        truths = {}
        for name, case in cases.items():
            file = os.path.join(folder, name, "truth.json")
            if not os.path.exists(file):
                raise Problem(file, "is missing; for hidden cases, name the file with --truth")
            truths[name] = Truth(read_json(file), file, case)
        return truths
    all_truths = expect(read_json(path), dict, path, "an object")
    for name in cases:
        if name not in all_truths:
            raise Problem(path, f"has no '{name}'")
    return {name: Truth(all_truths[name], f"{path}/{name}", case) for name, case in cases.items()}


class Answer:
    def __init__(self, value, place, case):
        expect(value, dict, place, "an object")
        for name in value:
            if name not in ("ranked", "causes", "repairs"):
                raise Problem(place, f"there is no {shown(name)} in an answer")
        self.ranked = names(value.get("ranked", []), f"{place}/ranked", case.suppliers)
        self.causes = names(value.get("causes", []), f"{place}/causes", case.suppliers)
        self.repairs = []
        for i, repair in enumerate(expect(value.get("repairs", []), list, f"{place}/repairs", "a list")):
            at = f"{place}/repairs/{i}"
            expect(repair, dict, at, "an object")
            component = names([repair.get("component")], at, case.suppliers)[0]
            if repair.get("repair") not in REPAIRS:
                raise Problem(at, f"its repair is none of {', '.join(REPAIRS)}")
            self.repairs.append((seconds(repair.get("at_s"), f"{at}/at_s"), component, repair["repair"]))


def read_answers(path, cases):
    value = expect(read_json(path), dict, path, "an object with an answer for each case")
    for name in value:
        if name not in cases:
            raise Problem(path, f"there is no case {shown(name)}")
    for name in cases:
        if name not in value:
            raise Problem(path, f"has no answer for '{name}'")
    return {name: Answer(value[name], f"{path}/{name}", case) for name, case in cases.items()}


# ---- scoring


def score_case(answer, truth):
    causes = set(truth.begins)
    found = len(causes.intersection(answer.ranked[:3]))
    wrong = useless = 0
    repaired = {}
    for at_s, component, repair in sorted(answer.repairs):
        if component not in causes:
            wrong += 1
        elif component in repaired or at_s < truth.begins[component] or repair not in truth.repairs[component]:
            useless += 1
        else:
            repaired[component] = at_s
    repairable = {name for name in causes if truth.repairs[name]}
    is_repaired = bool(repairable) and repairable <= set(repaired)
    return {
        "top1": float(answer.ranked[:1] != [] and answer.ranked[0] in causes),
        "top3": found / min(3, len(causes)),
        "exact": float(set(answer.causes) == causes),
        "wrong_components": wrong,
        "useless_repairs": useless,
        "repaired": float(is_repaired),
        "repaired_after_s": max(repaired.values()) - min(truth.begins.values()) if is_repaired else None,
    }


def score(answers, truths):
    cases = {name: score_case(answers[name], truths[name]) for name in truths}

    def mean(key):
        values = [case[key] for case in cases.values() if case[key] is not None]
        return sum(values) / len(values) if values else None

    means = {key: mean(key) for key in next(iter(cases.values()))}
    return {"cases": len(cases), **means, "by_case": cases}


# ---- simple methods


def first_failing(case):
    """Failing components by the begin of their failure."""
    return sorted(case.failing(), key=lambda c: (case.onset(c), c))


def upstream_first(case):
    """Failing components by the number of failing ones upstream of them."""
    failing = case.failing()
    count = {c: len(case.all_suppliers(c).intersection(failing)) for c in failing}
    return sorted(failing, key=lambda c: (count[c], case.onset(c), c))


def pagerank(case):
    """A walk from failing components to failing suppliers, also through unwatched components."""
    failing = case.failing()
    if not failing:
        return []
    nearest = {}
    for c in failing:
        found, seen, pending = set(), {c}, [c]
        while pending:
            for supplier in sorted(case.suppliers[pending.pop()] - seen):
                seen.add(supplier)
                if supplier in case.signals:
                    found.add(supplier)
                else:
                    pending.append(supplier)
        nearest[c] = sorted(found.intersection(failing)) or [c]
    share = dict.fromkeys(failing, 1 / len(failing))
    for _ in range(100):
        new = dict.fromkeys(failing, (1 - DAMPING) / len(failing))
        for c in failing:
            for supplier in nearest[c]:
                new[supplier] += DAMPING * share[c] / len(nearest[c])
        share = new
    return sorted(failing, key=lambda c: (-round(share[c], 9), c))


def correlated(a, b):
    """Pearson's coefficient; 0 if one of the signals never changes."""
    n = len(a)
    mean_a, mean_b = sum(a) / n, sum(b) / n
    variance = mean_a * (1 - mean_a) * mean_b * (1 - mean_b)
    if variance <= 0:
        return 0.0
    return (sum(x * y for x, y in zip(a, b)) / n - mean_a * mean_b) / math.sqrt(variance)


def correlation(case):
    """Components by how well the others' signals follow theirs, up to 3 s later."""
    step = (case.times[-1] - case.times[0]) / max(1, len(case.times) - 1)
    lags = sorted({round(lead / step) if step > 0 else 0 for lead in LEADS_S})
    result = {}
    for c in case.watched:
        total = 0.0
        for other in case.watched:
            if other != c:
                a, b = case.signals[c], case.signals[other]
                total += max(correlated(a[: len(a) - lag], b[lag:]) for lag in lags if lag < len(a) - 1)
        result[c] = total
    return sorted((c for c in case.watched if any(case.signals[c])), key=lambda c: (-round(result[c], 9), c))


def log_likelihood(ones, n):
    if ones in (0, n):
        return 0.0
    return ones * math.log(ones / n) + (n - ones) * math.log(1 - ones / n)


def rise(signal):
    """The reading at which the signal rises to another rate (maximum likelihood); None if there is none."""
    n, total = len(signal), sum(signal)
    best, split, before = math.log(n), None, 0  # by the Bayesian information criterion
    for at in range(1, n):
        before += signal[at - 1]
        gain = log_likelihood(before, at) + log_likelihood(total - before, n - at) - log_likelihood(total, n)
        if gain > best and before / at < (total - before) / (n - at):
            best, split = gain, at
    return split


def change_point(case):
    """As BARO does: find when the anomaly began, then rank by how far each signal departs from before.

    Signals here are 0 and 1, so the likelihood is Bernoulli's, and means stand for medians."""
    rises = [at for at in map(rise, case.signals.values()) if at is not None]
    if not rises:
        return []
    split, n = min(rises), len(case.times)

    def departure(c):
        signal = case.signals[c]
        before, after = sum(signal[:split]) / split, sum(signal[split:]) / (n - split)
        return (after - before) / max(0.1, math.sqrt(before * (1 - before)))

    result = {c: departure(c) for c in case.watched}
    return sorted((c for c in case.watched if result[c] > 0), key=lambda c: (-round(result[c], 9), c))


def chi_square_p(statistic, degrees):
    """The probability of a larger statistic: the upper incomplete gamma function of half the degrees."""
    y = statistic / 2
    s = 0.5 if degrees % 2 else 1.0
    p = math.erfc(math.sqrt(y)) if degrees % 2 else math.exp(-y)
    term = y**s * math.exp(-y) / math.gamma(s + 1)
    while s < degrees / 2:
        p += term
        s += 1
        term *= y / s
    return p


def independence_p(signal, failure, given, all_readings):
    """The chi-square test of two signals, given others. Signals are integers with a bit for each reading."""
    strata = [all_readings]
    for other in given:
        strata = [part for stratum in strata for part in (stratum & other, stratum & ~other)]
    statistic, degrees = 0.0, 0
    for stratum in strata:
        n, a, b, both = (bin(stratum & bits).count("1") for bits in (-1, signal, failure, signal & failure))
        if 0 < a < n and 0 < b < n:
            statistic += n * (both * n - a * b) ** 2 / (a * b * (n - a) * (n - b))
            degrees += 1
    return chi_square_p(statistic, degrees) if degrees else 1.0


def failure_neighbours(signals, failure, all_readings, alpha):
    """The signals that no other ones separate from the failure (the PC algorithm), the most significant first."""
    weakest = dict.fromkeys(signals, 0.0)  # the largest p of each
    size = 0
    while size < min(len(weakest), CHUNK):  # chunks that separate nothing leave many signals to the last stage
        for c in list(weakest):
            for given in itertools.combinations([other for other in weakest if other != c], size):
                p = independence_p(signals[c], failure, [signals[other] for other in given], all_readings)
                weakest[c] = max(weakest[c], p)
                if p > alpha:
                    del weakest[c]
                    break
        size += 1
    return sorted(weakest, key=lambda c: (weakest[c], c))


def causal_discovery(case):
    """RCD (Ikram et al., NeurIPS 2022): a failure is an intervention on its cause, so of all signals only those of causes
    depend on "before or after the failure began" whatever others are given. It looks for these in chunks, then among
    the chunks' findings.

    Here the failure begins with the first one that lasts. Signals are 0 and 1 already, and chunks are in the file's order."""
    failing = case.failing()
    if not failing:
        return []
    begin = min(map(case.onset, failing))

    def bits(values):
        return sum(1 << i for i, value in enumerate(values) if value)

    failure, all_readings = bits(t >= begin for t in case.times), bits([1] * len(case.times))
    signals = {c: bits(case.signals[c]) for c in case.watched}

    def neighbours(chunk, alpha):
        return failure_neighbours({c: signals[c] for c in chunk}, failure, all_readings, alpha)

    left, count = case.watched, None
    while left and len(left) != count:
        count = len(left)
        chunks = [left[i : i + CHUNK] for i in range(0, count, CHUNK)]
        left = [c for chunk in chunks for c in next(filter(None, (neighbours(chunk, a) for a in CHUNK_ALPHAS)), [])]
        if len(left) <= CHUNK:
            break
    ranked = []
    for alpha in LAST_ALPHAS:
        ranked += [c for c in neighbours(left, alpha) if c not in ranked]
    return ranked


BASELINES = {
    "upstream-first": upstream_first,
    "pagerank": pagerank,
    "correlation": correlation,
    "change-point": change_point,
    "causal-discovery": causal_discovery,
    "first-failing": first_failing,
}


def baseline_answer(case, ranked):
    """Names causes in the order of the ranking until they explain each failure by the graph."""
    unexplained = set(case.failing())
    upstream = {c: case.all_suppliers(c) | {c} for c in unexplained}
    answer = Answer({"ranked": ranked}, "baseline", case)
    for c in ranked:
        explained = {failure for failure in unexplained if c in upstream[failure]}
        if explained:
            answer.causes.append(c)
            unexplained -= explained
    answer.repairs = [(case.times[-1], c, "redeploy") for c in answer.causes]
    return answer


# ---- output

COLUMNS = (
    ("top1", "AC@1 [%]", 100),
    ("top3", "AC@3 [%]", 100),
    ("exact", "exact set [%]", 100),
    ("wrong_components", "wrong", 1),
    ("useless_repairs", "useless", 1),
    ("repaired", "repaired [%]", 100),
    ("repaired_after_s", "after [s]", 1),
)


def table(scores):
    rows = [["answers", *(title for _, title, _ in COLUMNS)]]
    for name, result in scores.items():
        digits = {100: 0, 1: 2}
        values = [
            "-" if result[key] is None else f"{result[key] * factor:.{digits[factor]}f}"
            for key, _, factor in COLUMNS
        ]
        rows.append([name, *values])
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return "\n".join(
        "  ".join([row[0].ljust(widths[0]), *(cell.rjust(w) for cell, w in zip(row[1:], widths[1:]))]).rstrip()
        for row in rows
    )


def certainty(count):
    """How far chance moves a share of so many cases at most, in percentage points (95 %, normal approximation)."""
    points = min(100.0, 100 * 1.96 * math.sqrt(0.25 / count))
    return f"{count} cases: a share is uncertain by up to {points:.0f} points (95 %)"


def run(arguments):
    cases = read_cases(arguments.cases)
    truths = read_truths(arguments.cases, arguments.truth, cases)
    scores = {}
    for path in arguments.answers:
        scores[os.path.splitext(os.path.basename(path))[0]] = score(read_answers(path, cases), truths)
    asked = BASELINES if "all" in arguments.baseline else arguments.baseline
    for name in asked:
        answers = {key: baseline_answer(case, BASELINES[name](case)) for key, case in cases.items()}
        scores[name] = score(answers, truths)
    if not scores:
        raise Problem("score.py", "name a file of answers, or a --baseline")
    if arguments.json:
        print(json.dumps(scores, indent=1))
    else:
        print(table(scores))
        print(certainty(len(cases)))


def main():
    parser = argparse.ArgumentParser(description="Scores answers to the cases of culprit's root-cause benchmark.")
    parser.add_argument("cases", help="folder with case-0001, case-0002, ...")
    parser.add_argument("answers", nargs="*", help="JSON files with answers (README.md)")
    parser.add_argument("--truth", metavar="FILE", help="truths of hidden cases (default: truth.json of each case)")
    parser.add_argument(
        "--baseline", action="append", default=[], choices=[*BASELINES, "all"], help="also a simple method of this script"
    )
    parser.add_argument("--json", action="store_true", help="print JSON, with the scores of each case")
    try:
        run(parser.parse_args())
    except Problem as problem:
        print(f"score.py: {problem}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())

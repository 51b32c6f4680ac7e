#!/usr/bin/env python3
"""Tests the claims of the paper again with SciPy, from a tidy file, and compares p, Holm's correction and verdicts.

    culprit study sunset --report FOLDER                    # writes FOLDER/claims.csv
    culprit study suave --claims --format csv -o FILE
    check_claims.py FILE...

Prints the number of claims. Exits with 1, and names the first figure that differs. Needs python3-scipy.
"""
import csv
import sys

import numpy
from scipy import stats

ALPHA = 0.05
FIRST, SECOND = "first", "second"


def expect(what, ours, theirs):
    if not numpy.isclose(ours, theirs, rtol=1e-6, atol=1e-9):
        sys.exit(f"{what}: culprit has {ours}, SciPy {theirs}")


def sample(part, which):
    """Mean, standard deviation and number; None without a spread that a test needs."""
    count = float(part[which + "_count"] or 0)
    return (float(part[which + "_mean"]), float(part[which + "_sd"]), count) if count >= 2 else None


def p_above(part, bound):
    """One-sided: the first mean is above the second, or above 0, by more than `bound`."""
    first = sample(part, FIRST)
    second = sample(part, SECOND) if part[SECOND] else (0.0, 0.0, None)
    if first is None or second is None:
        return 1.0
    mean, sd, count = first
    difference = mean - second[0] - (0 if part[SECOND] else float(part["bound"])) - bound
    if sd == 0 and second[1] == 0:
        return float(difference <= 0)
    if part[SECOND]:
        return stats.ttest_ind_from_stats(mean - bound, sd, count, *second, equal_var=False, alternative="greater").pvalue
    return stats.t.sf(difference / (sd / numpy.sqrt(count)), count - 1)


def turned(part):
    """The same with the other sign."""
    other = dict(part, bound=-float(part["bound"]))
    for which in (FIRST, SECOND):
        if part[which + "_mean"]:
            other[which + "_mean"] = -float(part[which + "_mean"])
    return other


def tested(part):
    """p for and against: Welch's or Student's t, or two one-sided tests of equivalence."""
    above, below, margin = part, turned(part), float(part["margin"])
    kind = part["comparison"]
    if kind in ("more", "above"):
        return p_above(above, 0), p_above(below, 0)
    if kind == "below":
        return p_above(below, 0), p_above(above, 0)
    larger = above if difference_of(part) >= 0 else below
    return max(p_above(above, -margin), p_above(below, -margin)), min(1.0, p_above(larger, margin) + p_above(larger, -margin))


def difference_of(part):
    return float(part["first_mean"] or 0) - (float(part["second_mean"] or 0) if part[SECOND] else float(part["bound"]))


def holm(ps):
    order, largest, adjusted = numpy.argsort(ps, kind="stable"), 0.0, [0.0] * len(ps)
    for place, i in enumerate(order):
        largest = max(largest, min(1.0, (len(ps) - place) * ps[i]))
        adjusted[i] = largest
    return adjusted


def verdict_of(p, p_against):
    return "holds" if p < ALPHA else "contradicted" if p_against < ALPHA else "open"


def check(parts):
    """All claims on one planner: each part, then Holm's correction of the intersection-union and of the Bonferroni p."""
    claims = {}
    for part in parts:
        p, against = tested(part)
        what = f"{part['claim']}: {part['first']} {part['comparison']} {part['second'] or part['bound']}"
        expect(what, float(part["part_p"]), p)
        expect(what + ", against", float(part["part_p_against"]), against)
        claims.setdefault(part["claim"], []).append((p, against, part))
    names = list(claims)
    holding = holm([max(p for p, _, _ in claims[name]) for name in names])
    against = holm([min(1.0, len(claims[name]) * min(q for _, q, _ in claims[name])) for name in names])
    for name, p, q in zip(names, holding, against):
        for _, _, part in claims[name]:
            expect(f"Holm, {name}", float(part["p"]), p)
            expect(f"Holm against {name}", float(part["p_against"]), q)
            if part["verdict"] != verdict_of(p, q):
                sys.exit(f"{name}: culprit says {part['verdict']}, SciPy {verdict_of(p, q)}")
    return len(names)


def main():
    count = 0
    for path in sys.argv[1:]:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        for key in dict.fromkeys((row["planner"], row["profile"]) for row in rows):
            count += check([row for row in rows if (row["planner"], row["profile"]) == key])
    if count == 0:
        sys.exit("check_claims.py: no claim was read")
    print(f"{count} claims are judged as SciPy does")


if __name__ == "__main__":
    main()

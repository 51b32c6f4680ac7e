"""Recomputes the statistics of `culprit study sunset --report FOLDER` with SciPy, from the values of all runs, and compares.

    check_statistics.py FOLDER

Prints the number of compared figures. Exits with 1, and names the first that differs.
"""
import re
import sys

import report  # first: it says which library is absent

import numpy
from scipy import stats

import sunset

checked = 0


def expect(what, ours, theirs, tolerance=1e-6):
    global checked
    checked += 1
    if not numpy.isclose(ours, theirs, rtol=tolerance, atol=tolerance):
        sys.exit(f"{what}: culprit has {ours}, SciPy {theirs}")


def key_of(row):
    return row["planner"], row["profile"], row["probabilities"], sunset.label({**row, "planner": "paper", "profile": "paper"}), row["metric"]


def values_of(data):
    """The values of each configuration and metric. Lower bounds are not among them."""
    values = {}
    for row in data.csv("values.csv"):
        values.setdefault(key_of(row), []).extend([row["value"]] * int(row["count"]))
    return values


def check_moments(data, values):
    for row in data.csv("metrics.csv"):
        known = values.get(key_of(row), [])
        if row["censored"] == 0 and row["count"] > 0:
            expect(f"count of {key_of(row)}", row["count"], len(known))
            expect(f"mean of {key_of(row)}", row["mean"], numpy.mean(known))
            expect(f"sd of {key_of(row)}", row["sd"], numpy.std(known))


def check_effects(data, values, metric):
    """Tukey's HSD among the eight configurations."""
    effects = [row for row in data.csv("effects.csv") if row["metric"] == metric]
    for planner, profile in dict.fromkeys((row["planner"], row["profile"]) for row in effects):
        groups = {key[3]: known for key, known in values.items()
                  if key[:3] == (planner, profile, "ideal") and key[4] == metric}
        names = list(groups)
        tukey = stats.tukey_hsd(*groups.values())
        for row in effects:
            if (row["planner"], row["profile"]) == (planner, profile):
                first, second = (names.index(row[end].replace("-", "–")) for end in ("from", "to"))
                what = f"Tukey, {metric}, {row['from']} to {row['to']}"
                expect(what, row["difference"], tukey.statistic[second, first])
                expect(what, row["p"], tukey.pvalue[second, first], 1e-4)


def table_of(data, name):
    return next((table for table in data.json("tables.json") if table["id"] == name), None)


def check_claims(data):
    """How many means of each metric are equivalent to the paper's, and how ours are ordered beside the paper's."""
    tests = sunset.equivalences(data)
    claims, order = table_of(data, "claims"), table_of(data, "order")
    rows = data.csv("metrics.csv")
    published = sunset.published_rows(rows)
    for place, (planner, profile) in enumerate(tests):
        for metric in sunset.PUBLISHED:
            title = sunset.METRICS[metric][0]
            mine = [test for test in tests[planner, profile] if test["metric"] == metric]
            claim = next(row for row in claims["rows"] if row[0]["text"] == f"means of {title}")
            equivalent = re.match(r"(\d+)/\d+", claim[2 + 3 * place]["text"])
            expect(f"claim on {title}", int(equivalent[1]), sum(test["p"] < 0.05 for test in mine))
            pairs = [(row["mean"], published[row["dependencies"], row["criticality"], row["impact"], metric][0])
                     for row in rows if (row["planner"], row["profile"], row["probabilities"], row["metric"]) ==
                     (planner, profile, "ideal", metric)]
            rho = next(row for row in order["rows"] if row[0]["text"] == title)[3 + 3 * place]["text"]
            expect(f"rho of {title}", float(rho.replace("−", "-")), stats.spearmanr(*zip(*pairs))[0], 0.006)


if __name__ == "__main__":
    folder = report.Data(sys.argv[1])
    runs = values_of(folder)
    check_moments(folder, runs)
    check_effects(folder, runs, "ratio")
    check_claims(folder)
    print(f"{checked} figures are as SciPy computes them")

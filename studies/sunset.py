"""The report of `culprit study sunset`: how well ours agree with the paper, tables, distributions, learning, timelines; or its sweep."""
import report  # first: it says which library is absent
from report import LIGHT

import numpy
from matplotlib import pyplot
from scipy import stats

PUBLISHED_RUNS = 162  # of each configuration of the paper
MARGIN_IN_SD = 0.5  # means that differ by less than this share of the paper's sd are alike

# Title and explanation of each metric; the first four are the paper's.
METRICS = {
    "ratio": ("resolved / executed", "Failures that went away for each executed strategy; above 1 where one strategy ended several failures."),
    "reaction_s": ("reaction [s]", "From the detection of a failure to its end; failures without an end are left out."),
    "downtime_s": ("downtime [s]", "Gaps between segmentations; a gap at the end of a run is left out."),
    "unnecessary_redeployments": ("unnecessary redeployments", "Redeployments beyond those that a fault needed."),
    "honest_downtime_s": ("honest downtime [s]", "Gaps between segmentations, also those at the beginning and at the end of a run."),
    "strategies_per_fault": ("strategies per fault", "Executed strategies for each injected fault."),
    "wrong_component": ("wrong component", "Adaptations of healthy components."),
    "unresolved": ("unresolved failures", "Failures that were left at the end of a run."),
    "recovery_s": ("recovery [s]", "From the first fault until all recovered; a run that did not recover counts to its end."),
    "root_cause_top1": ("root cause top-1", "Share of diagnoses whose most blamed component is a cause."),
    "root_cause_exact": ("root causes exact", "Share of diagnoses that blamed all causes and no other component."),
}
PUBLISHED = list(METRICS)[:4]


def label(row):
    switches = "".join(letter if row[name] else "–" for letter, name in
                       (("D", "dependencies"), ("C", "criticality"), ("S", "impact")))
    planner = "" if row["planner"] == "paper" else ", " + row["planner"]
    profile = "" if row["profile"] == "paper" else ", " + row["profile"]
    return switches + planner + profile + (", misspecified P" if row["probabilities"] == "misspecified" else "")


def ablations(rows):
    """The rows of each planner and profile of which all eight configurations have values of the paper's metrics."""
    groups = {}
    for row in rows:
        if row["probabilities"] == "ideal" and row["metric"] in PUBLISHED and row["mean"] is not None:
            groups.setdefault((row["planner"], row["profile"]), []).append(row)
    return {name: group for name, group in groups.items() if len({label(row) for row in group}) == 8}


def published_rows(rows):
    """Each published mean, by configuration and metric: all planners are compared with these."""
    return {(row["dependencies"], row["criticality"], row["impact"], row["metric"]): (row["published_mean"], row["published_sd"])
            for row in rows if row["probabilities"] == "ideal" and row["published_mean"] is not None}


# ---- statistics

def sample_sd(population_sd, count):
    return population_sd * (count / (count - 1)) ** 0.5


def equivalence(row, theirs):
    """Two one-sided Welch tests of ours against the paper's mean ± sd, and Hedges' g; nothing without a spread or two values.

    Values of one run are not independent: they count as "independent" ones (src/lab/study/statistics/clusters.h)."""
    if row["independent"] < 2 or row["sd"] == theirs[1] == 0:
        return None
    ours = (row["mean"], sample_sd(row["sd"], row["count"]), row["independent"])
    paper = (theirs[0], sample_sd(theirs[1], PUBLISHED_RUNS), PUBLISHED_RUNS)
    margin = MARGIN_IN_SD * theirs[1]

    def p(bound, alternative):
        return stats.ttest_ind_from_stats(ours[0] - bound, *ours[1:], *paper, equal_var=False, alternative=alternative).pvalue

    squares = ours[1] ** 2 / ours[2], paper[1] ** 2 / paper[2]
    degrees = sum(squares) ** 2 / (squares[0] ** 2 / (ours[2] - 1) + squares[1] ** 2 / (paper[2] - 1))
    reach = stats.t.ppf(0.95, degrees) * sum(squares) ** 0.5
    difference = ours[0] - paper[0]
    freedom = ours[2] + paper[2] - 2
    pooled = (((ours[2] - 1) * ours[1] ** 2 + (paper[2] - 1) * paper[1] ** 2) / freedom) ** 0.5
    return {"difference": difference, "low": difference - reach, "high": difference + reach, "sd": theirs[1],
            "p": max(p(-margin, "greater"), p(margin, "less")), "g": difference / pooled * (1 - 3 / (4 * freedom - 1))}


def holm(p):
    """Holm's correction, in the order of `p`."""
    order = numpy.argsort(p)
    corrected = numpy.minimum(1, numpy.maximum.accumulate((len(p) - numpy.arange(len(p))) * numpy.asarray(p)[order]))
    result = numpy.empty(len(p))
    result[order] = corrected
    return result


def equivalences(data):
    """By planner and profile: label, metric and test of each mean, with p by Holm over all of them."""
    rows = data.csv("metrics.csv")
    published = published_rows(rows)
    found = {}
    for name, group in ablations(rows).items():
        tests = []
        for row in group:
            theirs = published.get((row["dependencies"], row["criticality"], row["impact"], row["metric"]))
            if theirs and (test := equivalence(row, theirs)):
                tests.append({"label": label({**row, "planner": "paper", "profile": "paper"}), "metric": row["metric"], **test})
        if tests:
            for test, p in zip(tests, holm([test["p"] for test in tests])):
                test["p_holm"] = p
            found[name] = tests
    return found


# ---- figures

def equivalence_figure(tests):
    """The difference of each mean from the paper's, in the paper's sd, with its 90 % interval."""
    figure, axes = pyplot.subplots(1, 4, figsize=(10.5, 3.2), sharey=True, layout="constrained")
    labels = list(dict.fromkeys(test["label"] for test in tests))
    for axis, metric in zip(axes, PUBLISHED):
        axis.axvspan(-MARGIN_IN_SD, MARGIN_IN_SD, color=LIGHT["ours"], alpha=0.15, linewidth=0)
        axis.axvline(0, color=LIGHT["faint"], linewidth=1)
        for test in (test for test in tests if test["metric"] == metric and test["sd"] > 0):
            y = labels.index(test["label"])
            alike = test["p_holm"] < 0.05
            axis.plot([test["low"] / test["sd"], test["high"] / test["sd"]], [y, y], color=LIGHT["ours"], linewidth=2)
            axis.plot(test["difference"] / test["sd"], y, "o", color=LIGHT["ours"], markersize=6,
                      markerfacecolor=LIGHT["ours"] if alike else "white")
        axis.set_title(METRICS[metric][0])
        axis.set_yticks(range(len(labels)), labels)
        axis.set_xlim(*(limit * 1.1 for limit in symmetric(axis.get_xlim())))
        axis.grid(axis="x")
    axes[0].invert_yaxis()
    figure.supxlabel("ours − the paper's mean, in the paper's sd", color=LIGHT["faint"], fontsize=9)
    return figure


def symmetric(limits):
    largest = max(abs(limits[0]), abs(limits[1]), 1)
    return -largest, largest


def distribution_figure(metric, rows, values):
    """A histogram for each configuration; below it our mean with its interval, and the paper's mean ± sd."""
    height = 0.62 * len(rows) + 0.9
    figure, axis = pyplot.subplots(figsize=(7.4, height), layout="constrained")
    known = [value for row in rows for value in values.get(label(row), ([], []))[0]]
    integers = bool(known) and all(value == int(value) for value in known)
    # A few values far out would press all others together: they are counted at the end of their row.
    high = max([numpy.quantile(numpy.repeat(*values[label(row)]), 0.995) for row in rows if label(row) in values] + [0])
    shown = [bound for row in rows for bound in (row["mean"], row["ci_high"], *published_range(row)) if bound is not None]
    low, high = min(known + shown + [0]), max(shown + [high, 0])
    high = high if high > low else low + 1
    whole = integers and high - low < 60
    edges = numpy.arange(numpy.floor(low) - 0.5, numpy.ceil(high) + 1) if whole else numpy.linspace(low, high, 61)
    for place, row in enumerate(rows):
        base = len(rows) - 1 - place
        counts = values.get(label(row))
        if counts is None or row["mean"] is None:
            axis.text(edges[0], base + 0.1, " no values", color=LIGHT["faint"])
        else:
            draw_row(axis, row, counts, edges, base)
    axis.set_yticks([len(rows) - 1 - place for place in range(len(rows))], map(label, rows))
    axis.set_ylim(-0.5, len(rows) - 0.2)
    axis.set_xlim(edges[0], edges[-1])
    if whole:
        axis.xaxis.get_major_locator().set_params(integer=True)
    axis.set_xlabel(METRICS[metric][0])
    axis.grid(axis="x")
    axis.spines["left"].set_visible(False)
    axis.tick_params(axis="y", length=0, labelcolor=LIGHT["ink"])
    handles = [axis.plot([], [], "o-", color=LIGHT["ours"], markersize=4, label="our mean, 95 % interval")[0]]
    if any(row["published_mean"] is not None for row in rows):
        handles += axis.plot([], [], "D-", color=LIGHT["theirs"], markersize=4, markerfacecolor="none", label="the paper's mean ± 1 sd")
    axis.legend(handles=handles, loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0.1, ncols=2)
    return figure


def published_range(row):
    if row["published_mean"] is None:
        return []
    return [row["published_mean"] - row["published_sd"], row["published_mean"] + row["published_sd"]]


def draw_row(axis, row, counts, edges, base):
    heights, _ = numpy.histogram(counts[0], edges, weights=counts[1])
    widths = numpy.diff(edges)
    axis.bar(edges[:-1] + widths / 2, 0.6 * heights / max(heights.max(), 1), widths * 0.86, bottom=base, color=LIGHT["ours"], alpha=0.45)
    axis.axhline(base, color=LIGHT["faint"], linewidth=0.8)
    if row["ci_low"] is not None:
        axis.plot([row["ci_low"], row["ci_high"]], [base - 0.11] * 2, color=LIGHT["ours"], linewidth=2)
    axis.plot(row["mean"], base - 0.11, "o", color=LIGHT["ours"], markersize=4)
    if row["published_mean"] is not None:
        axis.plot(published_range(row), [base - 0.25] * 2, color=LIGHT["theirs"], linewidth=1.5)
        axis.plot(row["published_mean"], base - 0.25, "D", color=LIGHT["theirs"], markersize=4, markerfacecolor="white")
    beyond = int(sum(count for value, count in zip(*counts) if value > edges[-1]))
    notes = [f"+{beyond} ▸"] * (beyond > 0) + [f"{int(row['censored'])} never"] * (row["censored"] > 0)
    axis.annotate(" ".join(notes), (1, base + 0.2), xycoords=("axes fraction", "data"), xytext=(4, 0), textcoords="offset points",
                  color=LIGHT["faint"], annotation_clip=False)


def learning_figure(curves):
    """Learned success probabilities over the experiments, with ± 1 sd over the series, and the true rates."""
    figure, axis = pyplot.subplots(figsize=(7.4, 3.6), layout="constrained")
    last = len(curves[0]["learned"])
    ends = apart([curve["believed"] for curve in curves], 0.055)
    for i, curve in enumerate(curves):
        colour = report.CURVES[i % len(report.CURVES)]
        x = numpy.arange(last + 1)
        mean = numpy.array([curve["initial"]] + [after["mean"] for after in curve["learned"]])
        sd = numpy.array([0] + [after["sd"] for after in curve["learned"]])
        axis.fill_between(x, numpy.maximum(0, mean - sd), numpy.minimum(1, mean + sd), color=colour, alpha=0.15, linewidth=0)
        axis.plot(x, mean, color=colour, linewidth=2)
        axis.axhline(curve["truth"], color=colour, linestyle=(0, (2, 3)), linewidth=1.3)
        axis.annotate(f"{curve['strategy']} {curve['believed']:.2f} (true {curve['truth']:.2f})", (last, curve["believed"]),
                      xytext=(1.03, ends[i]), textcoords="axes fraction", color=colour, va="center", annotation_clip=False,
                      arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.8})
    axis.set_xlim(0, max(1, last))
    axis.set_ylim(0, 1)
    axis.set_xlabel("experiments")
    axis.set_ylabel("success probability; dotted: true rate")
    axis.grid(axis="y")
    return figure


def apart(places, distance):
    """Moves places that are too near away from one another, in their order, and keeps them within 0 to 1."""
    order = sorted(range(len(places)), key=lambda i: places[i])
    moved = list(places)
    for below, above in zip(order, order[1:]):
        moved[above] = max(moved[above], moved[below] + distance)
    excess = max(0, max(moved) - 1)
    return [place - excess for place in moved]


# ---- the page

def agreement_section(data, page):
    metrics, effects = data.csv("metrics.csv"), data.csv("effects.csv")
    body = ""
    for (planner, profile), tests in equivalences(data).items():
        own = [row for row in effects if (row["planner"], row["profile"]) == (planner, profile)]
        theirs = [row for row in own if row["published_verdict"] != "none"]
        within = [abs(test["difference"]) <= test["sd"] for test in tests]
        scores = [
            (sum(test["p_holm"] < 0.05 for test in tests), len(tests), "means equivalent to the paper's (TOST, Holm)"),
            (sum(within), len(within), "means within the paper's mean ± 1 sd"),
            (sum(row["same_sign"] for row in theirs), len(theirs), "significant effects with the paper's sign"),
            (sum(row["verdict"] == row["published_verdict"] for row in own), len(own),
             "effects with the paper's verdict (better, worse, not significant)"),
        ]
        boxes = "".join(f'<div class="score"><strong>{part} of {whole}</strong><span>{report.escaped(text)}</span></div>\n'
                        for part, whole, text in scores)
        body += f'<h3>{report.escaped(planner)} planner, {report.escaped(profile)} profile</h3>\n<div class="scores">\n{boxes}</div>\n'
        body += page.figure(
            f"equivalence-{planner}-{profile}", "Equivalence with the paper.",
            "Difference of each mean with its 90 % interval. Equivalent (filled) if two one-sided Welch tests show that it lies within half "
            "of the paper's sd (shaded), with Holm's correction.", equivalence_figure(tests))
        page.tables.append(equivalence_table(planner, profile, tests))
        body += report.table_html(page.tables[-1])
    if body:
        page.section("agreement", "Agreement with the paper", body)


def number(value, decimals=2):
    return f"{value:.{decimals}f}".replace("-", "−")


def equivalence_table(planner, profile, tests):
    columns = [("configuration", "left"), ("metric", "left"), ("difference", "right"), ("90 % interval", "right"),
               ("margin", "right"), ("p (TOST)", "right"), ("p (Holm)", "right"), ("Hedges' g", "right")]
    return {
        "id": report.safe_id(f"equivalence-{planner}-{profile}"),
        "caption": f"Each mean beside the paper's: {planner} planner, {profile} profile",
        "columns": [{"group": "", "title": title, "align": align} for title, align in columns],
        "rows": [[{"text": text, "bold": test["p_holm"] < 0.05 and i == 6} for i, text in enumerate((
            test["label"], METRICS[test["metric"]][0], number(test["difference"]),
            f"{number(test['low'])} to {number(test['high'])}", number(MARGIN_IN_SD * test["sd"]),
            report.p_value(test["p"]), report.p_value(test["p_holm"]), number(test["g"])))] for test in tests],
        "notes": ["Reaction times of one run are not independent, and count for less. The paper does not print how many it pooled; they count as one a run."],
    }


def plot_section(data, page):
    rows = data.csv("metrics.csv")
    values = {}
    for line in data.csv("values.csv"):
        found, counts = values.setdefault(line["metric"], {}).setdefault(label(line), ([], []))
        found.append(line["value"])
        counts.append(int(line["count"]))
    body = ""
    for metric, (title, explanation) in METRICS.items():
        mine = [row for row in rows if row["metric"] == metric]
        if any(row["mean"] is not None for row in mine):
            body += page.figure(metric, title, explanation + " Bars are relative to the highest of their row.",
                                distribution_figure(metric, mine, values.get(metric, {})))
    curves = data.json("study.json").get("learning", [])
    for failure in dict.fromkeys(curve["failure"] for curve in curves):
        mine = [curve for curve in curves if curve["failure"] == failure]
        body += page.figure(f"learning-{failure}", f"learned success probabilities, {failure}", f"Strategies of {mine[0]['rule']}.",
                            learning_figure(mine))
    page.section("plots", "Plots", f'<div class="plots">\n{body}</div>\n')


# ---- the sweep of the constants that the paper leaves open

def sweep_figure(points):
    """How ours are ordered beside the paper's, by the time of a relaunch; and where both orders agree at once."""
    figure, axes = pyplot.subplots(1, 3, figsize=(10.5, 3.8), layout="constrained")
    relaunches = sorted({point["relaunch_s"] for point in points})
    windows = sorted({point["window"] for point in points})
    for axis, metric in zip(axes, ("reaction_s", "downtime_s")):
        for i, window in enumerate(windows):
            mine = [point for point in points if point["window"] == window]
            x = [point["relaunch_s"] + 0.09 * (i - (len(windows) - 1) / 2) for point in mine]
            axis.plot(x, [point["rho"][metric] for point in mine], "o", color=report.CURVES[i], markersize=3.5, alpha=0.7, linewidth=0,
                      label=f"window {window:g}")
        means = [numpy.mean([point["rho"][metric] or 0 for point in points if point["relaunch_s"] == relaunch]) for relaunch in relaunches]
        axis.plot(relaunches, means, color=LIGHT["ink"], linewidth=1.5, label="mean")
        axis.axhline(0, color=LIGHT["faint"], linewidth=1)
        axis.set(title=f"ρ of {METRICS[metric][0]}", xlabel="relaunch [s]", ylim=(-1.05, 1.05), xticks=relaunches)
        axis.grid(axis="y")
    axes[0].legend(fontsize=7.5, loc="upper left", bbox_to_anchor=(0, -0.2), ncols=4, columnspacing=0.8, handletextpad=0.2)
    axes[2].fill_between([0, 1.05], 0, 1.05, color=LIGHT["ours"], alpha=0.15, linewidth=0)
    for i, relaunch in enumerate(relaunches):
        mine = [point["rho"] for point in points if point["relaunch_s"] == relaunch]
        axes[2].plot([rho["reaction_s"] for rho in mine], [rho["downtime_s"] for rho in mine], "o", color=report.CURVES[i], markersize=4,
                     alpha=0.7, label=f"relaunch {relaunch:g} s")
    axes[2].set(title="both at once", xlabel="ρ of reaction", ylabel="ρ of downtime", xlim=(-1.05, 1.05), ylim=(-1.05, 1.05))
    axes[2].legend(fontsize=7.5, loc="upper left", bbox_to_anchor=(0, -0.2), ncols=2, columnspacing=0.8, handletextpad=0.2)
    axes[2].grid()
    return figure


def sweep_report(data, study):
    campaign, points = study["campaign"], study["sweep"]
    page = report.Report("SUNSET: the constants that the paper leaves open", [
        ("Command", campaign["command"]), ("Seed", campaign["seed"]), ("Version", f"culprit {campaign['version']}"),
        ("Points", f"{len(points)}, each of 8 configurations × {campaign['runs']} runs")],
        "Spearman's ρ between our means of the eight configurations and the paper's. Each dot is a point of a full factorial design.")
    body = ""
    for planner in dict.fromkeys(point["planner"] for point in points):
        body += page.figure(
            f"sweep-{planner}", f"{planner}.", "In the shaded part both orders are like the paper's.",
            sweep_figure([point for point in points if point["planner"] == planner]))
    page.section("plots", "Plots", body)
    page.table_section(data.json("tables.json"))
    return page


def timeline_section(data, page):
    runs = data.json("timelines.json")
    if not runs:
        return
    heads = "".join(f'<th scope="col" class="{align}">{title}</th>' for title, align in
                    (("time [s]", "right"), ("kind", "left"), ("component", "left"), ("what", "left")))
    page.section("runs", "Timeline of a run", (
        "<p>Failures, blamed components, and repairs. A broad line shows how long a component was failing.</p>\n"
        "<noscript><p>The timelines need JavaScript; all else on this page does not.</p></noscript>\n"
        '<div class="chooser"><label for="run">Run</label><select id="run"></select></div>\n<ul class="kinds" id="kinds"></ul>\n'
        '<div id="timeline-drawing"></div>\n<div class="wide"><table id="timeline-table">\n<caption>The same in words</caption>\n'
        f"<thead><tr>{heads}</tr></thead>\n<tbody></tbody>\n</table></div>\n"))
    page.script = (f'<script type="application/json" id="timelines">{report.script_data(runs)}</script>\n'
                   f"<script>\n{(report.HERE / 'timeline.js').read_text(encoding='utf-8')}</script>\n")


def report_of(data):
    study = data.json("study.json")
    if "sweep" in study:
        return sweep_report(data, study)
    campaign = study["campaign"]
    page = report.Report("SUNSET", [
        ("Command", campaign["command"]), ("Seed", campaign["seed"]), ("Version", f"culprit {campaign['version']}"),
        ("Runs", f"{len(campaign['rows'])} configurations × {campaign['runs']} runs")])
    agreement_section(data, page)
    page.table_section(data.json("tables.json"))
    plot_section(data, page)
    timeline_section(data, page)
    return page


if __name__ == "__main__":
    report.main(report_of)

"""The report of `culprit study rca`: the planners beside one another or, with --learn, how true what was learned is."""
import report  # first: it says which library is absent
from report import LIGHT

import numpy
from matplotlib import pyplot


def calibration_figure(calibration):
    """Observed over predicted frequency; on the dotted line both agree. The larger a circle, the more forecasts."""
    figure, axis = pyplot.subplots(figsize=(4.6, 4.6), layout="constrained")
    axis.plot([0, 1], [0, 1], color=LIGHT["curve0"], linestyle=(0, (2, 3)), linewidth=1.3)
    bins = calibration["bins"]
    x, y = [each["forecast"] for each in bins], [each["came_true"] for each in bins]
    shares = numpy.array([each["count"] for each in bins]) / max(1, calibration["outcomes"])
    axis.plot(x, y, color=LIGHT["ours"], linewidth=2)
    axis.scatter(x, y, (4 + 20 * numpy.sqrt(shares)) ** 2, color=LIGHT["ours"], zorder=3, clip_on=False)
    axis.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="forecast", ylabel="came true")
    axis.grid()
    return figure


def learning_report(study):
    campaign, learning = study["campaign"], study["learning"]
    factors = learning.get("factors_in_words", "")
    page = report.Report("Learning on one robot", [
        ("Command", campaign["command"]), ("Version", f"culprit {campaign['version']}"),
        ("Robot", f"{learning['components']} components, {learning['faults']} faults at once" + (", " + factors if factors else "")),
        ("Learned from", f"{learning['faults_learned']} faults" +
         ("; success rates changed for the last quarter" if learning["drift"] else "")),
        ("Measured on", f"{learning['faults_measured']} faults after these"),
        ("Each strategy", f"{learning['rate_error']:.3f} from how often it helped, in the mean"),
        ("Forgetting", f"{learning['forgetting']:g}")],
        "The belief just before each outcome, beside the share that came true. On the dotted line both agree; the larger a circle, "
        "the more outcomes.")
    body = ""
    for name, title in (("success", "Success of strategies"), ("kappa", "Failures that clear with another (kappa)")):
        caption = f"Expected calibration error {learning[name]['expected_calibration_error']:.3f} of {learning[name]['outcomes']} outcomes."
        body += page.figure(name, title + ".", caption, calibration_figure(learning[name]))
    page.section("calibration", "Calibration", f'<div class="plots">\n{body}</div>\n')
    return page


def setting_of(row):
    words = f"{row['components']} components, {row['faults']} faults" + (f", noise {row['noise']:g}" if row["noise"] else "")
    return words + (", cyclic" if row["cyclic"] else "") + (", " + row["factors"] if row.get("factors") else "")


FIGURES = (("exact_set", "exact set [%]", 100), ("wrong_component", "wrong components", 1), ("recovery_s", "recovery [s]", 1))


def planners_figure(rows):
    """Three means of each planner; those on the Pareto front are filled."""
    figure, axes = pyplot.subplots(1, 3, figsize=(10.5, 0.3 * len(rows) + 0.9), sharey=True, layout="constrained")
    for axis, (key, title, factor) in zip(axes, FIGURES):
        for y, row in enumerate(rows):
            axis.barh(y, factor * row[key], height=0.6, color=LIGHT["ours"], alpha=0.75 if row["on_front"] else 0.3)
            axis.annotate(f"{factor * row[key]:.3g}", (factor * row[key], y), xytext=(4, 0), textcoords="offset points", va="center",
                          color=LIGHT["faint"], fontsize=8)
        axis.set_title(title)
        axis.margins(x=0.15)
        axis.grid(axis="x")
    axes[0].set_yticks(range(len(rows)), [row["planner"] for row in rows])
    axes[0].invert_yaxis()
    return figure


def campaign_report(data, study):
    campaign = study["campaign"]
    page = report.Report("Root causes on random robots", [
        ("Seed", campaign["seed"]), ("Version", f"culprit {campaign['version']}"), ("Episodes", campaign["episodes"])])
    page.table_section(data.json("tables.json"))
    body = ""
    for setting in dict.fromkeys(map(setting_of, study["rows"])):
        body += page.figure("planners-" + setting, setting + ".", "Means over the episodes. Dark: no other planner is better in every respect.",
                            planners_figure([row for row in study["rows"] if setting_of(row) == setting]))
    page.section("plots", "Plots", body)
    return page


def report_of(data):
    study = data.json("study.json")
    return learning_report(study) if "learning" in study else campaign_report(data, study)


if __name__ == "__main__":
    report.main(report_of)

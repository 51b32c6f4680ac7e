"""Tables of a study as LaTeX, like the paper's: with booktabs, and with xcolor's [table] option. Needs no library.

    latex.py TABLES.json OUTPUT
"""
import json
import sys

SPELLED = {
    "\\": "\\textbackslash{}", "{": "\\{", "}": "\\}", "%": "\\%", "&": "\\&", "#": "\\#", "$": "\\$", "_": "\\_",
    "^": "\\^{}", "~": "\\~{}", "±": "$\\pm$", "−": "$-$",
    "–": "\\textendash{}",  # dashes in a row would become another sign
    "<": "$<$", ">": "$>$", "|": "$|$", "✓": "\\checkmark", "✗": "$\\times$", "Δ": "$\\Delta$", "ρ": "$\\rho$",
}
ALIGNED = {"left": "l", "centre": "c", "right": "r"}


def escaped(text):
    return "".join(SPELLED.get(letter, letter) for letter in text)


def head_spans(columns):
    """Neighbours that share a head: from, and to before."""
    spans = []
    for i, column in enumerate(columns):
        if spans and column["group"] and columns[i - 1]["group"] == column["group"]:
            spans[-1][1] = i + 1
        else:
            spans.append([i, i + 1])
    return spans


def cell(cell):
    # As the paper: grey for what is not significant, else the stronger the larger.
    percent = min(100, max(1, round(cell.get("strength", 0) * 100)))
    colour = {"not_significant": "gray!25", "better": f"green!{percent}", "worse": f"red!{percent}"}.get(cell.get("shade"))
    text = f"\\textbf{{{escaped(cell['text'])}}}" if cell.get("bold") else escaped(cell["text"])
    return (f"\\cellcolor{{{colour}}}" if colour else "") + text


def table(table):
    columns = table["columns"]
    lines = ["% needs \\usepackage{amsmath,amssymb,booktabs} and \\usepackage[table]{xcolor}",
             "\\begin{table}[ht]", "\\centering", f"\\caption{{{escaped(table['caption'])}}}", f"\\label{{tab:{table['id']}}}",
             f"\\begin{{tabular}}{{{''.join(ALIGNED[column['align']] for column in columns)}}}", "\\toprule"]
    spans = head_spans(columns)
    if any(column["group"] for column in columns):
        lines.append(" & ".join(
            f"\\multicolumn{{{end - begin}}}{{c}}{{{columns[begin].get('group_latex') or escaped(columns[begin]['group'])}}}"
            if columns[begin]["group"] else "" for begin, end in spans) + " \\\\")
        lines.append("".join(f"\\cmidrule(lr){{{begin + 1}-{end}}}" for begin, end in spans if columns[begin]["group"]))
    lines.append(" & ".join(column.get("title_latex") or escaped(column["title"]) for column in columns) + " \\\\")
    lines.append("\\midrule")
    lines += [" & ".join(map(cell, row)) + " \\\\" for row in table["rows"]]
    lines += ["\\bottomrule", "\\end{tabular}"]
    for note in table["notes"]:
        lines += ["", "\\smallskip", f"{{\\footnotesize {escaped(note)}}}"]
    return "\n".join(lines + ["\\end{table}", ""])


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as source, open(sys.argv[2], "w", encoding="utf-8") as output:
        output.write("\n".join(map(table, json.load(source))))

# How `make docs` makes a searchable site of docs/: Sphinx with MyST (Markdown) and the theme of Read the Docs, all of Debian. It needs no
# network, neither to build nor to read: the search works from the files too (file://).
import os
import re

project = "culprit"
html_title = "culprit"
html_theme = "sphinx_rtd_theme"
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
html_show_sourcelink = False
# Excerpts of pages would be fetched, which browsers forbid to pages that are files.
html_show_search_summary = False
extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["site"]
root_doc = "README"
myst_heading_anchors = 4  # as GitHub has them
# The grammar and the schema of docs/, and code blocks of languages that nobody knows here.
suppress_warnings = ["misc.highlighting_failure"]
nitpicky = True


def contents(text):
    """The lists of README.md, as the site's navigation."""
    trees = []
    for part in re.split(r"^## ", text, flags=re.M)[1:]:
        caption, _, body = part.partition("\n")
        pages = re.findall(r"^- \[[^\]]+\]\((\S+)\.md\)", body, flags=re.M)
        trees.append("```{toctree}\n:hidden:\n:caption: " + caption.strip() + "\n\n" + "\n".join(pages) + "\n```\n")
    return "\n".join(trees)


def read(app, name, source):
    text = source[0]

    def outside(match):
        """What is beside docs/ is a file to be had; of a folder, or a document, only the words stay."""
        words, target = match.group(1), match.group(2).split("#")[0]
        path = os.path.normpath(os.path.join(app.srcdir, target))
        is_file = os.path.isfile(path) and not path.endswith(".md")
        return f"[{words}]({target})" if is_file else words

    text = re.sub(r"\[([^\]]+)\]\((\.\./[^)]+)\)", outside, text)
    source[0] = text + "\n" + contents(text) if name == "README" else text


def finish(app, error):
    """Where a folder is opened, its first page."""
    if not error:
        with open(os.path.join(app.outdir, "index.html"), "w") as page:
            page.write('<!doctype html><meta http-equiv="refresh" content="0; url=README.html"><title>culprit</title>')


def setup(app):
    app.connect("source-read", read)
    app.connect("build-finished", finish)

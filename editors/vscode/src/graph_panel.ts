// The graph of a rule file, in a panel beside it: what `culprit graph FILE --json` says of the file as it is saved, drawn by
// view/graph_view.ts. Where the file has mistakes, culprit's own message stands there.
//
// The content comes from rule files, and those from anywhere: the panel runs no script but ours, loads nothing, and can only
// ask to go to a place that it was given.
import { execFile } from "child_process";
import { randomBytes } from "crypto";
import { basename, dirname } from "path";
import { ExtensionContext, Range, TextDocument, Uri, ViewColumn, WebviewPanel, window, workspace } from "vscode";
import type { Asked, Place, RuleGraph, Shown } from "./rule_graph";

const kMostBytes = 64 * 1024 * 1024; // a rule file has 4 MB at most
const kPatience = 30_000; // ms

// A page may show our style and run our script.
export function page(title: string, script: string, style: string, source: string): string {
  const nonce = randomBytes(16).toString("hex");
  const policy = `default-src 'none'; style-src ${source}; script-src 'nonce-${nonce}'`;
  const escaped = (text: string) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="${policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="stylesheet" href="${escaped(style)}">
<title>${escaped(title)}</title>
</head>
<body>
<main></main>
<script nonce="${nonce}" src="${escaped(script)}"></script>
</body>
</html>`;
}

function graphOf(program: string, file: string): Promise<Pick<Shown, "graph" | "trouble">> {
  return new Promise((resolve) => {
    const options = { cwd: dirname(file), maxBuffer: kMostBytes, timeout: kPatience };
    execFile(program, ["graph", file, "--json"], options, (error, said, trouble) => {
      const fails = (why: string) => resolve({ graph: null, trouble: why });
      if (error?.killed) return fails(`'${program} graph' took longer than ${kPatience / 1000} s.`);
      if (error && trouble === "")
        return fails(`'${program} graph' does not run (${error.message}). The setting culprit.path says where culprit is.`);
      if (error) return fails(trouble);
      try {
        resolve({ graph: JSON.parse(said) as RuleGraph, trouble: "" });
      } catch {
        fails(`What '${program} graph' said is no graph: is it as new as this extension?`);
      }
    });
  });
}

// culprit counts characters, the editor UTF-16 units.
function unitsBefore(line: string, column: number): number {
  return Array.from(line).slice(0, column - 1).join("").length;
}

class GraphPanel {
  private graph: RuleGraph | null = null;
  private shown: Shown;
  private asked = 0; // times

  constructor(
    private readonly panel: WebviewPanel,
    private readonly file: string,
    private readonly program: () => string,
    private readonly editor: ViewColumn | undefined,
  ) {
    this.shown = { file: basename(file), graph: null, trouble: "" };
    panel.webview.onDidReceiveMessage((asked: Asked) => void this.answer(asked));
  }

  // Shows only the last of several at once.
  async refresh(): Promise<void> {
    const mine = ++this.asked;
    const { graph, trouble } = await graphOf(this.program(), this.file);
    if (mine !== this.asked) return;
    if (graph) this.graph = graph;
    this.shown = { file: basename(this.file), graph: this.graph, trouble };
    await this.panel.webview.postMessage(this.shown);
  }

  reveal(): void {
    this.panel.reveal();
  }

  // A page that was hidden is loaded anew, and knows nothing.
  private async answer(asked: Asked): Promise<void> {
    if (asked.what === "ready") {
      if (this.shown.graph || this.shown.trouble) await this.panel.webview.postMessage(this.shown);
      return;
    }
    const list = asked.what === "component" ? this.graph?.components : this.graph?.rules;
    const place = list?.[asked.index];
    if (place?.file !== undefined) await this.goTo(place as Place);
  }

  private async goTo({ file, line, column }: Place): Promise<void> {
    try {
      const document = await workspace.openTextDocument(Uri.file(file));
      const row = Math.min(line, document.lineCount) - 1;
      const at = unitsBefore(document.lineAt(row).text, column);
      await window.showTextDocument(document, { viewColumn: this.editor, selection: new Range(row, at, row, at) });
    } catch (error) {
      void window.showErrorMessage(`${file} cannot be opened: ${error instanceof Error ? error.message : String(error)}`);
    }
  }
}

// One panel for each file.
export class GraphPanels {
  private readonly panels = new Map<string, GraphPanel>();

  constructor(
    private readonly context: ExtensionContext,
    private readonly program: () => string,
  ) {}

  async show(document: TextDocument, editor: ViewColumn | undefined): Promise<void> {
    const file = document.fileName;
    const open = this.panels.get(file);
    if (open) {
      open.reveal();
      return open.refresh();
    }
    const scripts = Uri.joinPath(this.context.extensionUri, "dist");
    const title = `Graph of ${basename(file)}`;
    const panel = window.createWebviewPanel(
      "culprit-graph",
      title,
      { viewColumn: ViewColumn.Beside, preserveFocus: true },
      { enableScripts: true, localResourceRoots: [scripts] },
    );
    const made = new GraphPanel(panel, file, this.program, editor);
    this.panels.set(file, made);
    panel.onDidDispose(() => this.panels.delete(file));
    const address = (name: string) => panel.webview.asWebviewUri(Uri.joinPath(scripts, name)).toString();
    panel.webview.html = page(title, address("graph_view.js"), address("graph_view.css"), panel.webview.cspSource);
    await made.refresh();
  }

  // Any of them may include what was saved.
  saved(): void {
    for (const panel of this.panels.values()) void panel.refresh();
  }
}

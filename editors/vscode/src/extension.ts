// Starts `culprit lsp` for rule files, and again when its settings change. A file that ends in .rules counts as
// ours only if it begins as ours do: udev has such files, too.
import { execFile } from "child_process";
import { dirname } from "path";
import { commands, Diagnostic, ExtensionContext, languages, TextDocument, Uri, window, workspace } from "vscode";
import { LanguageClient } from "vscode-languageclient/node";
import { GraphPanels } from "./graph_panel";

let client: LanguageClient | undefined;

const program = () => workspace.getConfiguration("culprit").get<string>("path", "culprit");

// The code of a mistake leads to what it means: a document that `culprit explain` writes.
const kExplained = "culprit-explain";
const kCode = /^[A-Z]\d{3}$/;

function link(diagnostics: Diagnostic[]): void {
  for (const diagnostic of diagnostics) {
    const code = diagnostic.code;
    if (typeof code === "string" && kCode.test(code))
      diagnostic.code = { value: code, target: Uri.from({ scheme: kExplained, path: code }) };
  }
}

function explain({ path }: Uri): Promise<string> {
  if (!kCode.test(path)) return Promise.resolve(`${path} is not the code of a mistake.`);
  return new Promise((resolve) =>
    execFile(program(), ["explain", path], (error, said, trouble) => resolve(error ? trouble || error.message : said)),
  );
}

async function start(): Promise<void> {
  const settings = workspace.getConfiguration("culprit");
  const command = program();
  const args = settings.get<boolean>("robot", false) ? ["lsp", "--robot"] : ["lsp"];
  client = new LanguageClient(
    "culprit",
    "culprit",
    { command, args },
    {
      documentSelector: [{ language: "culprit-rules" }],
      middleware: {
        handleDiagnostics: (uri, diagnostics, next) => {
          link(diagnostics);
          next(uri, diagnostics);
        },
      },
    },
  );
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    const reason = error instanceof Error ? error.message : String(error);
    void window.showErrorMessage(
      `'${command} lsp' does not run (${reason}). The setting culprit.path says where culprit is.`,
    );
  }
}

async function stop(): Promise<void> {
  const running = client;
  client = undefined;
  await running?.stop();
}

async function restart(): Promise<void> {
  await stop();
  await start();
}

const kLanguage = "culprit-rules";
const kMostLines = 1000; // of comments in front
const kStatements = /^\s*(ROBOT|CYCLE|COMPONENT|DEPENDENCY|IGNORE|INTERLOCK|ABORT|DRILL|CONST|SIGNAL|RULE|INCLUDE|TEMPLATE|USE)\b/;

// Its first line that is neither empty nor a comment is one of the language.
function isOurs(document: TextDocument): boolean {
  for (let i = 0; i < Math.min(document.lineCount, kMostLines); ++i) {
    const line = document.lineAt(i).text;
    if (line.trim() !== "" && !line.trim().startsWith("#")) return kStatements.test(line);
  }
  return false;
}

function claim(document: TextDocument): void {
  if (document.languageId === kLanguage || !document.fileName.endsWith(".rules")) return;
  if (isOurs(document)) void languages.setTextDocumentLanguage(document, kLanguage);
}

// The one that is being edited, if it is a file of rules.
function ruleFile(): TextDocument | undefined {
  const document = window.activeTextEditor?.document;
  if (document?.languageId === kLanguage && document.uri.scheme === "file") return document;
  void window.showErrorMessage("Open a rule file of culprit first, and save it.");
  return undefined;
}

// In a terminal, as the program of that terminal: no shell reads the file's name.
async function runInTerminal(name: string, args: (file: string) => string[]): Promise<void> {
  const document = ruleFile();
  if (document === undefined || !(await document.save())) return;
  const file = document.fileName;
  window.createTerminal({ name, shellPath: program(), shellArgs: args(file), cwd: dirname(file) }).show();
}

async function showGraph(panels: GraphPanels): Promise<void> {
  const document = ruleFile();
  if (document !== undefined) await panels.show(document, window.activeTextEditor?.viewColumn);
}

async function runOnRobot(): Promise<void> {
  const kRun = "Run";
  const detail = "culprit watches the robot of this computer's ROS_DOMAIN_ID and changes it by these rules until its terminal is closed.";
  const answer = await window.showWarningMessage("Run culprit with these rules?", { modal: true, detail }, kRun);
  if (answer === kRun) await runInTerminal("culprit run", (file) => ["run", file]);
}

export async function activate(context: ExtensionContext): Promise<void> {
  workspace.textDocuments.forEach(claim);
  const graphs = new GraphPanels(context, program);
  context.subscriptions.push(
    workspace.onDidOpenTextDocument(claim),
    workspace.onDidSaveTextDocument((document) => {
      claim(document);
      if (document.languageId === kLanguage) graphs.saved();
    }),
    workspace.registerTextDocumentContentProvider(kExplained, { provideTextDocumentContent: explain }),
    commands.registerCommand("culprit.restart", restart),
    commands.registerCommand("culprit.graph", () => showGraph(graphs)),
    commands.registerCommand("culprit.test", () => runInTerminal("culprit test", (file) => ["test", dirname(file)])),
    commands.registerCommand("culprit.plan", () => runInTerminal("culprit plan", (file) => ["plan", file, "--robot"])),
    commands.registerCommand("culprit.web", () => runInTerminal("culprit web", (file) => ["web", file])),
    commands.registerCommand("culprit.run", runOnRobot),
    workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("culprit")) void restart();
    }),
  );
  await start();
}

export function deactivate(): Promise<void> {
  return stop();
}

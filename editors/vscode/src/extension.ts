// Starts `culprit lsp` for rule files, and again when its settings change.
import { commands, ExtensionContext, window, workspace } from "vscode";
import { LanguageClient } from "vscode-languageclient/node";

let client: LanguageClient | undefined;

async function start(): Promise<void> {
  const settings = workspace.getConfiguration("culprit");
  const command = settings.get<string>("path", "culprit");
  const args = settings.get<boolean>("robot", false) ? ["lsp", "--robot"] : ["lsp"];
  client = new LanguageClient(
    "culprit",
    "culprit",
    { command, args },
    { documentSelector: [{ language: "culprit-rules" }] },
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

export async function activate(context: ExtensionContext): Promise<void> {
  context.subscriptions.push(
    commands.registerCommand("culprit.restart", restart),
    workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("culprit")) void restart();
    }),
  );
  await start();
}

export function deactivate(): Promise<void> {
  return stop();
}

// An editor with one file open: the client library that Visual Studio Code uses, on `culprit lsp`.
import { spawn } from "node:child_process";
import { createRequire } from "node:module";

const require = createRequire(import.meta.url);
const protocol = require("vscode-languageserver-protocol/node");
const { TextDocument } = require("vscode-languageserver-textdocument");

const kUri = "file:///robot.rules";
const kPatience = 20_000; // ms; only what fails takes so long

export class Editor {
  constructor(command) {
    this.server = spawn(command[0], command.slice(1), { stdio: ["pipe", "pipe", "inherit"] });
    this.ended = new Promise((resolve) => this.server.on("exit", resolve));
    this.connection = protocol.createProtocolConnection(
      new protocol.StreamMessageReader(this.server.stdout),
      new protocol.StreamMessageWriter(this.server.stdin),
    );
    this.published = [];
    this.waiting = [];
    this.connection.onNotification(protocol.PublishDiagnosticsNotification.type, (params) => {
      this.published.push(params.diagnostics);
      this.waiting = this.waiting.filter((isDone) => !isDone());
    });
    this.connection.listen();
  }

  async open(text) {
    const reply = await this.connection.sendRequest(protocol.InitializeRequest.type, {
      processId: process.pid, rootUri: null, capabilities: {},
    });
    await this.connection.sendNotification(protocol.InitializedNotification.type, {});
    this.document = TextDocument.create(kUri, "culprit-rules", 1, text);
    await this.connection.sendNotification(protocol.DidOpenTextDocumentNotification.type, {
      textDocument: { uri: kUri, languageId: "culprit-rules", version: 1, text },
    });
    return reply;
  }

  // Applies edits as an editor does, and notifies the server.
  async apply(edits) {
    const text = TextDocument.applyEdits(this.document, edits);
    const version = this.document.version + 1;
    this.document = TextDocument.create(kUri, "culprit-rules", version, text);
    await this.connection.sendNotification(protocol.DidChangeTextDocumentNotification.type, {
      textDocument: { uri: kUri, version }, contentChanges: [{ text }],
    });
  }

  // Waits until the codes of the last diagnostics are these.
  diagnosed(...codes) {
    const isSo = () => this.published.at(-1)?.map((d) => d.code).join() === codes.join();
    return new Promise((resolve, reject) => {
      const giveUp = () => reject(new Error(`not [${codes}]: ${JSON.stringify(this.published)}`));
      const timer = setTimeout(giveUp, kPatience);
      const isDone = () => isSo() && (clearTimeout(timer), resolve(this.published.at(-1)), true);
      if (!isDone()) this.waiting.push(isDone);
    });
  }

  // The position of `text`, `offset` characters into it.
  at(text, offset = 0) {
    const found = this.document.getText().indexOf(text);
    if (found < 0) throw new Error(`'${text}' is not in the file`);
    return this.document.positionAt(found + offset);
  }

  ask(type, params) {
    return this.connection.sendRequest(type, { textDocument: { uri: kUri }, ...params });
  }
  async labels(position) {
    return (await this.ask(protocol.CompletionRequest.type, { position })).map((i) => i.label);
  }
  async hover(position) {
    return (await this.ask(protocol.HoverRequest.type, { position }))?.contents.value ?? "";
  }
  rename(position, newName) {
    return this.ask(protocol.RenameRequest.type, { position, newName }).then((e) => e.changes[kUri]);
  }
  format() {
    const options = { tabSize: 2, insertSpaces: true };
    return this.ask(protocol.DocumentFormattingRequest.type, { options });
  }
  definition(position) {
    return this.ask(protocol.DefinitionRequest.type, { position });
  }
  symbols() {
    return this.ask(protocol.DocumentSymbolRequest.type, {});
  }
  // The edits of the one quick fix for `diagnostic`.
  async quickFix(diagnostic) {
    const actions = await this.ask(protocol.CodeActionRequest.type, {
      range: diagnostic.range, context: { diagnostics: [diagnostic], only: ["quickfix"] },
    });
    if (actions.length !== 1 || !actions[0].isPreferred) throw new Error(JSON.stringify(actions));
    return actions[0].edit.changes[kUri];
  }

  // The exit code of the server.
  async close() {
    await this.connection.sendRequest(protocol.ShutdownRequest.type);
    await this.connection.sendNotification(protocol.ExitNotification.type);
    return this.ended;
  }
}

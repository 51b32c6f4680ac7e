// A stand-in of Visual Studio Code for the test of the panel: a browser shows its content, and its requests are noted.
export const ViewColumn = { One: 1, Beside: -2 }
export class Uri {
  constructor(path) {
    this.scheme = 'file'
    this.path = this.fsPath = path
  }
  static file = (path) => new Uri(path)
  static joinPath = (uri, ...parts) => new Uri([uri.path, ...parts].join('/'))
}
export class Range {
  constructor(startLine, startCharacter) {
    Object.assign(this, { startLine, startCharacter })
  }
}

export const noted = { panels: [], opened: [], errors: [] }
export const served = { origin: '', read: null } // by the test

export const window = {
  createWebviewPanel(type, title, where, options) {
    const panel = {
      title,
      where,
      options,
      reveals: 0,
      reveal: () => ++panel.reveals,
      onDidDispose: (gone) => (panel.dispose = gone),
      webview: {
        html: '',
        cspSource: served.origin,
        asWebviewUri: (uri) => ({ toString: () => `${served.origin}/${uri.path.split('/').pop()}` }),
        onDidReceiveMessage: (answer) => (panel.says = answer),
        postMessage: (message) => panel.told?.(message),
      },
    }
    noted.panels.push(panel)
    return panel
  },
  async showTextDocument(document, options) {
    noted.opened.push({ file: document.file, line: options.selection.startLine, at: options.selection.startCharacter, column: options.viewColumn })
  },
  showErrorMessage: (text) => noted.errors.push(text),
}
export const workspace = {
  async openTextDocument({ path }) {
    const lines = served.read(path).split('\n')
    return { file: path, lineCount: lines.length, lineAt: (row) => ({ text: lines[row] }) }
  },
}

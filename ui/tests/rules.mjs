// Writing rules in the browser, with and without knowing the language.
import { buildsThePapersRule, losesNothingToASlowServer, saysThatARuleCannotHelp, showsWhatIsSaidOfTheNewestText } from './builder.mjs'
import { losesNothingThatWasWritten } from './drafts.mjs'
import { drawsTheFile } from './file_graph.mjs'
import { writesEveryRow } from './grammar.mjs'
import { mendsABrokenFile } from './repair.mjs'
import { isFirefox, suite } from './session.mjs'
import { writesThreeRules } from './task.mjs'

// In Firefox the form and the editor as a person uses them; what the page makes of late answers and of each row is its own.
await suite(async () => {
  await buildsThePapersRule()
  await mendsABrokenFile()
  if (isFirefox) return
  await saysThatARuleCannotHelp()
  await drawsTheFile()
  await losesNothingToASlowServer()
  await showsWhatIsSaidOfTheNewestText()
  await writesEveryRow()
  await writesThreeRules()
  await losesNothingThatWasWritten()
})

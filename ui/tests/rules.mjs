// Writing rules in the browser, with and without knowing the language.
import { buildsThePapersRule, losesNothingToASlowServer, showsWhatIsSaidOfTheNewestText } from './builder.mjs'
import { losesNothingThatWasWritten } from './drafts.mjs'
import { writesEveryRow } from './grammar.mjs'
import { mendsABrokenFile } from './repair.mjs'
import { suite } from './session.mjs'
import { writesThreeRules } from './task.mjs'

await suite(async () => {
  await buildsThePapersRule()
  await losesNothingToASlowServer()
  await showsWhatIsSaidOfTheNewestText()
  await mendsABrokenFile()
  await writesEveryRow()
  await writesThreeRules()
  await losesNothingThatWasWritten()
})

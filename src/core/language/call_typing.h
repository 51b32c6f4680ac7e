// The types of calls: what each function of the language takes and gives (language/functions.h).
#pragma once

#include <optional>

#include "language/syntax.h"
#include "language/typer.h"
#include "language/typing.h"

namespace culprit {

// `typer` types the arguments, and takes what is wrong. Nothing: it was reported.
std::optional<Typed> type_call(const syntax::Expression& call, Typer& typer);

}  // namespace culprit

// Model files of system_modes: whatever the text is, it is refused with a place and a reason, or
// its model holds together: parts come before their systems, and every mode that is named is there.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "modes/inference.h"
#include "modes/read_model.h"

namespace {

using namespace culprit::modes;

void require(bool holds) {
  if (!holds) __builtin_trap();
}

void check(const Model& model, const Entity& entity) {
  require(!entity.modes.empty() && entity.modes.front().name == kDefaultMode);
  for (const std::string& part : entity.parts) {
    const Entity* found = model.find(part);
    require(found != nullptr && found < &entity);
    for (const Mode& mode : entity.modes) {
      const Target& target = mode.parts.at(part);
      require(!target.is_active || found->find(target.mode) != nullptr);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto model =
      read_model("fuzz.yaml", std::string(reinterpret_cast<const char*>(data), size));
  if (!model) {
    require(model.error().starts_with("fuzz.yaml:"));
    return 0;
  }
  for (const Entity& entity : model->entities) check(*model, entity);
  Inference inference(*model);
  for (const Entity& entity : model->entities)
    inference.set_target(entity.name, {true, entity.modes.back().name});
  inference.infer();
  return 0;
}

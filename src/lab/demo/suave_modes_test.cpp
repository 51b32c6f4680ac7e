// The mode file of the live SUAVE says what its model says.
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "exemplars/suave/model/mission.h"
#include "modes/read_model.h"

namespace culprit::lab {
namespace {

// What a mode comes to for the node that is its system's one part.
struct Effect {
  bool is_active = false;
  std::map<std::string, Value> parameters;
  bool operator==(const Effect&) const = default;
};

Effect effect_of(const modes::Model& model, const modes::Target& part, const std::string& node) {
  if (!part.is_active) return {};
  auto parameters = model.find(node)->find(part.mode)->parameters;
  parameters.erase("system_mode_marker");
  return {true, std::move(parameters)};
}

TEST(SuaveModes, OfTheLiveRobotAreThoseOfItsModel) {
  const auto text = read_text("rules/suave-modes.yaml");
  ASSERT_TRUE(text) << text.error();
  const auto model = modes::read_model("suave-modes.yaml", *text);
  ASSERT_TRUE(model) << model.error();
  for (const simulation::ModeSystem& system : suave::model::mode_systems()) {
    const modes::Entity* live = model->find(system.name);
    ASSERT_NE(live, nullptr) << system.name;
    ASSERT_EQ(live->modes.size(), system.modes.size()) << system.name;
    for (const simulation::SystemMode& mode : system.modes) {
      const modes::Mode* found = live->find(mode.name);
      ASSERT_NE(found, nullptr) << system.name << " " << mode.name;
      const simulation::PartMode& part = mode.parts.front();
      EXPECT_EQ(effect_of(*model, found->parts.at(part.node), part.node),
                (Effect{part.is_active, part.parameters}))
          << system.name << " " << mode.name;
    }
  }
}

}  // namespace
}  // namespace culprit::lab

// The mode file of the live SUAVE says what its model says.
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "exemplars/suave/live_names.h"
#include "exemplars/suave/model/mission.h"
#include "modes/read_model.h"

namespace culprit::lab {
namespace {

// Markers are in the file alone: there every mode sets a parameter.
modes::Entity without_marker(modes::Entity entity) {
  for (modes::Mode& mode : entity.modes) mode.parameters.erase(suave::kModeMarker);
  return entity;
}

TEST(SuaveModes, OfTheLiveRobotAreThoseOfItsModel) {
  const auto text = read_text("rules/suave-modes.yaml");
  ASSERT_TRUE(text) << text.error();
  const auto live = modes::read_model("suave-modes.yaml", *text);
  ASSERT_TRUE(live) << live.error();
  const modes::Model model = suave::model::mode_model();
  ASSERT_EQ(live->entities.size(), model.entities.size());
  for (const modes::Entity& entity : model.entities) {
    const modes::Entity* found = live->find(entity.name);
    ASSERT_NE(found, nullptr) << entity.name;
    EXPECT_EQ(without_marker(*found), entity) << entity.name;
  }
}

}  // namespace
}  // namespace culprit::lab

// SUAVE's behaviour tree, which leads the mission and adapts the robot in one.
//
// Where its delays come from: the tree is ticked, then sleeps 100 ms, and each action under way
// sleeps 50 ms within the tick; before a mode is changed it is read. Numbers are read with single
// precision, in which the battery is not below a quarter when it is in double precision. A mode
// that the blackboard already has is not set again.
#pragma once

#include "managers/suave_manager.h"

namespace culprit::study {

class BtManager : public SuaveManager {
 public:
  explicit BtManager(const Setting& setting);

 private:
  Routine live();
  Routine tick();
  Routine search();
  Routine inspect();
  Routine recharge();
  Routine ground(std::string system, std::string mode);
  // A subtree that failed ends the tick.
  bool has_failed() const { return has_failed_; }
  bool is_charged() const;
  void on_signal(const std::string& name, const Value& value) override;

  std::map<std::string, std::string> blackboard_;  // by system, the mode that was set last
  bool has_failed_ = false;
  bool is_recharging_ = false;
  bool has_recharged_ = false;
};

}  // namespace culprit::study

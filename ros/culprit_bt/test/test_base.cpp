// A node of the live test of modes: /drive_base, with a lifecycle and a limit of its speed. It says what becomes of it.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "rclcpp/rclcpp.hpp"
#include "rclcpp_lifecycle/lifecycle_node.hpp"

namespace {

constexpr double kFastest = 2.0;  // m/s; it refuses more

void say(const std::string& words) {
  std::printf("%s\n", words.c_str());
  std::fflush(stdout);
}

class Base : public rclcpp_lifecycle::LifecycleNode {
 public:
  Base() : LifecycleNode("drive_base") {
    declare_parameter("max_speed", 1.0);
    checks_ = add_on_set_parameters_callback([](const std::vector<rclcpp::Parameter>& wanted) {
      rcl_interfaces::msg::SetParametersResult result;
      result.successful = true;
      for (const rclcpp::Parameter& each : wanted) {
        if (each.get_name() != "max_speed") continue;
        result.successful = each.as_double() <= kFastest;
        result.reason = result.successful ? "" : "it cannot go as fast";
        say((result.successful ? "max_speed " : "refuses ") + std::to_string(each.as_double()));
      }
      return result;
    });
  }

  CallbackReturn on_activate(const rclcpp_lifecycle::State&) override {
    say("active");
    return CallbackReturn::SUCCESS;
  }
  CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) override {
    say("inactive");
    return CallbackReturn::SUCCESS;
  }

 private:
  OnSetParametersCallbackHandle::SharedPtr checks_;
};

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  const auto base = std::make_shared<Base>();
  base->configure();
  say("configured");
  rclcpp::spin(base->get_node_base_interface());
  rclcpp::shutdown();
  return 0;
}

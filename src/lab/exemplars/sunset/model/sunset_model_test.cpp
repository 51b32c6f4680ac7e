#include "exemplars/sunset/model/sunset_model.h"

#include <algorithm>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "simulation/fault.h"

namespace culprit::sunset::model {
namespace {

using namespace std::chrono_literals;

// Hears the model's diagnostics.
class Ear : public simulation::Watcher {
 public:
  explicit Ear(SunsetModel& model) : world_(model.world()) { world_.watch(*this); }
  ~Ear() override { world_.unwatch(*this); }

  double number(const std::string& key) const { return std::get<double>(last_.at(key)); }
  bool has(const std::string& key) const { return last_.contains(key); }
  bool flag(const std::string& key) const { return std::get<bool>(last_.at(key)); }
  std::vector<double> entropies;

 private:
  void on_diagnostic(std::string_view status, std::string_view key, const Value& value) override {
    last_[std::string(status) + " " + std::string(key)] = value;
    if (status == "segmentation" && key == "entropy") entropies.push_back(std::get<double>(value));
  }
  void on_node(const simulation::Node&, bool) override {}
  void on_endpoint(const simulation::Node&, EndpointKind, const std::string&, bool) override {}
  void on_sample(const simulation::TopicBase&) override {}
  void on_parameter(const simulation::Node&, const std::string&, const Value&) override {}
  void on_lifecycle(const simulation::Node&) override {}
  void on_process(const simulation::Node&, const std::string&) override {}

  simulation::World& world_;
  std::map<std::string, Value> last_;
};

const Profile& profile(const char* name) { return **find_profile(name); }

struct Sunset {
  explicit Sunset(const char* name = "paper", std::uint64_t seed = 1) : model(profile(name), seed) {
    model.world().run(Time{8s});
    model.evaluator().restart();
  }
  void run_for(Duration time) { model.world().run(later(model.world().now(), time)); }
  void set(Member member, const std::string& parameter, const Value& value) {
    EXPECT_TRUE(model.node(member).set_parameter(parameter, value)) << parameter;
  }
  void strike(const Fault& fault) { set(fault.member, std::string(fault.name), fault.value); }
  void restart(Member member) {
    EXPECT_TRUE(model.node(member).change(Transition::kDeactivate));
    EXPECT_TRUE(model.node(member).change(Transition::kActivate));
  }
  void redeploy(Member member) {
    simulation::Node& node = model.node(member);
    node.terminate([&node] { node.launch(); });
  }
  bool is_well() {
    run_for(5s);
    return model.evaluator().is_well();
  }

  SunsetModel model;
};

TEST(SunsetModel, IsWellWhileNothingIsWrong) {
  for (const Profile& each : profiles()) {
    SunsetModel model(each, 1);
    model.world().run(Time{8s});
    model.evaluator().restart();
    model.world().run(Time{68s});
    EXPECT_EQ(model.evaluator().downtime().total(model.world().now()), 0s) << each.name;
    EXPECT_FALSE(model.evaluator().last_unwell()) << each.name;
  }
}

TEST(SunsetModel, HasTheEntropyOfTheExemplarsLogs) {
  Sunset sunset;
  Ear ear(sunset.model);
  const auto mean_of_ten_minutes = [&] {
    ear.entropies.clear();
    sunset.run_for(600s);
    double sum = 0;
    for (const double e : ear.entropies) sum += e;
    return sum / static_cast<double>(ear.entropies.size());
  };
  EXPECT_NEAR(mean_of_ten_minutes(), 0.032, 0.002);
  EXPECT_LT(*std::max_element(ear.entropies.begin(), ear.entropies.end()), 0.06);
  sunset.strike(*find_fault("image_degradation"));
  sunset.run_for(2s);
  EXPECT_NEAR(mean_of_ten_minutes(), 0.106, 0.001);
  EXPECT_GT(*std::min_element(ear.entropies.begin(), ear.entropies.end()), 0.09);
}

// Facts 2.1: what really resolves each fault, and that the other remedy of an outage does not.
TEST(SunsetModel, EachFaultIsEndedByItsRemedyOnly) {
  for (const char* name : {"paper", "head", "live"}) {
    for (const Fault& fault : faults()) {
      if (fault.criticality != Criticality::kError) continue;
      Sunset sunset(name);
      sunset.strike(fault);
      EXPECT_FALSE(sunset.is_well()) << name << " " << fault.name;
      sunset.restart(fault.member);
      EXPECT_EQ(sunset.is_well(), fault.resolved_by.size() == 2) << name << " " << fault.name;
      sunset.redeploy(fault.member);
      sunset.run_for(8s);
      EXPECT_TRUE(sunset.is_well()) << name << " " << fault.name;
    }
  }
}

TEST(SunsetModel, APoorSegmentationIsEndedByItsRemedyOnly) {
  Sunset shifted;
  shifted.strike(*find_fault("image_shift"));
  EXPECT_FALSE(shifted.is_well());
  shifted.set(Member::kSensorFusion, "do_recalibration", true);
  EXPECT_TRUE(shifted.is_well());

  Sunset dark;
  dark.strike(*find_fault("image_degradation"));
  EXPECT_FALSE(dark.is_well());
  dark.set(Member::kSensorFusion, "do_recalibration", true);
  EXPECT_FALSE(dark.is_well());
  ASSERT_TRUE(dark.model.node(Member::kImageEnhancement).change(Transition::kActivate));
  dark.set(Member::kSensorFusion, "topic_camera_input", std::string("rgb_enhanced"));
  EXPECT_TRUE(dark.is_well());
}

TEST(SunsetModel, EnhancingAHealthyPictureMakesItWorse) {
  Sunset sunset;
  ASSERT_TRUE(sunset.model.node(Member::kImageEnhancement).change(Transition::kActivate));
  sunset.set(Member::kSensorFusion, "topic_camera_input", std::string("rgb_enhanced"));
  EXPECT_FALSE(sunset.is_well());
  sunset.set(Member::kSensorFusion, "topic_camera_input", std::string("rgb_camera"));
  EXPECT_TRUE(sunset.is_well());
}

TEST(SunsetModel, RefusesAnInputThatDoesNotExist) {
  Sunset sunset;
  EXPECT_FALSE(sunset.model.node(Member::kSensorFusion)
                   .set_parameter("topic_camera_input", std::string("rgb")));
}

TEST(SunsetModel, AutofocusEndsTheBlur) {
  Sunset sunset;
  Ear ear(sunset.model);
  sunset.strike(*find_fault("autofocus_needed"));
  sunset.run_for(2s);
  EXPECT_TRUE(ear.flag("blackboard camera_autofocus_needed"));
  sunset.set(Member::kCamera, "perform_autofocus", true);
  sunset.run_for(2s);
  EXPECT_FALSE(ear.flag("blackboard camera_autofocus_needed"));
}

// Facts 3.1: W / 1 Hz - (W - 1) / f after the last picture, and up to a period of publishing more.
TEST(SunsetModel, TheBlackboardIsBlindForSeconds) {
  struct Case {
    const char* profile;
    Duration blind;
    Duration period;
  };
  for (const Case& c : {Case{"paper", 3700ms, 700ms}, Case{"head", 9100ms, 700ms}}) {
    Sunset sunset(c.profile);
    Ear ear(sunset.model);
    sunset.run_for(1s);
    EXPECT_GT(ear.number("blackboard rgb_camera_freq"), 9);
    EXPECT_GT(ear.number("blackboard sensors_fused_freq"), 9);
    sunset.strike(*find_fault("camera_driver_issue"));
    sunset.run_for(c.blind - 200ms);
    EXPECT_GE(ear.number("blackboard rgb_camera_freq"), 1) << c.profile;
    sunset.run_for(200ms + c.period + 10ms);
    EXPECT_LT(ear.number("blackboard rgb_camera_freq"), 1) << c.profile;
  }
}

TEST(SunsetModel, AnOutageShowsBehindTheFusionLater) {
  Sunset sunset;
  Ear ear(sunset.model);
  sunset.strike(*find_fault("camera_driver_issue"));
  sunset.run_for(100ms);
  const std::size_t before = ear.entropies.size();
  sunset.run_for(2s);
  EXPECT_GE(ear.entropies.size(), before + 3);  // old pairs, on the depth pictures' arrivals
  EXPECT_LE(ear.entropies.size(), before + 8);
}

TEST(SunsetModel, WhatWasSetOutlivesTheProcessWhereTheProfileSaysSo) {
  for (const auto& [name, is_kept] : {std::pair("paper", true), std::pair("october", false)}) {
    Sunset sunset(name);
    sunset.strike(*find_fault("image_shift"));
    sunset.redeploy(Member::kSensorFusion);
    sunset.run_for(3s);
    EXPECT_EQ(sunset.model.has(*find_fault("image_shift")), is_kept) << name;
  }
}

TEST(SunsetModel, IsTheSameForTheSameSeed) {
  const auto entropies = [](std::uint64_t seed) {
    Sunset sunset("paper", seed);
    Ear ear(sunset.model);
    sunset.run_for(10s);
    return ear.entropies;
  };
  EXPECT_EQ(entropies(5), entropies(5));
  EXPECT_NE(entropies(5), entropies(6));
}

TEST(Frequency, IsTheExemplars) {
  const std::deque<Time> arrivals = {Time{0ms}, Time{100ms}, Time{200ms}, Time{300ms}};
  EXPECT_DOUBLE_EQ(frequency(arrivals, 4, Time{400ms}), 10);
  EXPECT_DOUBLE_EQ(frequency(arrivals, 4, Time{2s}), 2);  // 4 in 2 s
  EXPECT_EQ(frequency(arrivals, 5, Time{400ms}), 0);
  EXPECT_EQ(frequency(arrivals, 4, Time{300ms}), std::numeric_limits<double>::infinity());
}

TEST(Profile, SaysWhichThereAre) {
  EXPECT_EQ(find_profile("september").error(),
            "there is no profile 'september'; there are paper, head, october, live");
}

}  // namespace
}  // namespace culprit::sunset::model

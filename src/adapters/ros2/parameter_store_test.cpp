#include "ros2/parameter_store.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Names = std::vector<std::string>;

msg::Parameter parameter(std::string name, const Value& value) {
  return {std::move(name), to_parameter_value(value)};
}

// The answer to setting this one parameter: "ok", or the reason why not.
std::string set(ParameterStore& store, const std::string& name, const Value& value) {
  const msg::Parameter change = parameter(name, value);
  const msg::SetParametersResult result = store.set({&change, 1});
  return result.successful ? "ok" : result.reason;
}

ParameterStore store_with(const std::string& name, const Value& value,
                          msg::ParameterDescriptor descriptor = {}) {
  ParameterStore store("/node");
  EXPECT_TRUE(store.declare(name, value, std::move(descriptor)));
  return store;
}

TEST(ParameterStore, SetsWhatIsDeclared) {
  ParameterStore store = store_with("gain", 1.0);
  EXPECT_EQ(set(store, "gain", 2.5), "ok");
  EXPECT_EQ(store.get<double>("gain"), 2.5);
}

TEST(ParameterStore, RefusesWhatIsNotDeclared) {
  ParameterStore store("/node");
  EXPECT_EQ(set(store, "gain", 1.0), "parameter 'gain' cannot be set because it was not declared");
}

TEST(ParameterStore, RefusesAnotherType) {
  ParameterStore store = store_with("gain", 1.0);
  EXPECT_EQ(set(store, "gain", std::int64_t{1}),
            "Wrong parameter type, parameter {gain} is of type {double}, setting it to {integer} "
            "is not allowed.");
  const msg::Parameter unset{"gain", {}};
  EXPECT_EQ(store.set({&unset, 1}).reason, "cannot undeclare an statically typed parameter");
  EXPECT_EQ(store.get<double>("gain"), 1.0);
}

TEST(ParameterStore, RefusesToChangeWhatIsReadOnly) {
  msg::ParameterDescriptor descriptor;
  descriptor.read_only = true;
  ParameterStore store = store_with("serial", std::string("SN-1"), descriptor);
  EXPECT_EQ(set(store, "serial", std::string("x")),
            "parameter 'serial' cannot be set because it is read-only");
}

TEST(ParameterStore, KeepsDoublesInTheirRange) {
  msg::ParameterDescriptor descriptor;
  descriptor.floating_point_range = {{0, 1, 0.25}};
  ParameterStore store = store_with("gain", 0.5, descriptor);
  EXPECT_EQ(set(store, "gain", 0.75), "ok");
  EXPECT_EQ(set(store, "gain", 1.0), "ok");
  for (const double bad : {0.6, -0.25, 1.25, std::nan("")}) {
    EXPECT_EQ(set(store, "gain", bad), "Parameter {gain} doesn't comply with floating point range.")
        << bad;
  }
}

TEST(ParameterStore, KeepsIntegersInTheirRange) {
  msg::ParameterDescriptor descriptor;
  descriptor.integer_range = {{INT64_MIN, INT64_MAX, 2}};
  ParameterStore store = store_with("count", std::int64_t{0}, descriptor);
  EXPECT_EQ(set(store, "count", std::int64_t{2}), "ok");
  EXPECT_EQ(set(store, "count", std::int64_t{INT64_MAX}),
            "ok");  // an end counts, whatever the step
  EXPECT_EQ(set(store, "count", std::int64_t{3}),
            "Parameter {count} doesn't comply with integer range.");
}

TEST(ParameterStore, ACallbackMayRefuse) {
  ParameterStore store = store_with("count", std::int64_t{1});
  store.on_set([](std::span<const msg::Parameter> changes) -> Expected<void> {
    if (changes[0].value.integer_value < 0) return Error{"count must not be negative"};
    return {};
  });
  EXPECT_EQ(set(store, "count", std::int64_t{-1}), "count must not be negative");
  EXPECT_EQ(store.get<std::int64_t>("count"), 1);
  EXPECT_EQ(set(store, "count", std::int64_t{5}), "ok");
}

TEST(ParameterStore, SetsAllOrNothing) {
  ParameterStore store("/node");
  ASSERT_TRUE(store.declare("a", Value(true)));
  ASSERT_TRUE(store.declare("b", Value(1.0)));
  const std::vector<msg::Parameter> changes = {parameter("a", false), parameter("b", false)};
  EXPECT_FALSE(store.set(changes).successful);
  EXPECT_TRUE(store.get<bool>("a"));
}

TEST(ParameterStore, DeclaresOnlyOnceAndOnlyWithAValue) {
  ParameterStore store = store_with("gain", 1.0);
  EXPECT_EQ(store.declare("gain", Value(2.0)).error(),
            "parameter 'gain' has already been declared");
  EXPECT_EQ(store.declare("", Value(2.0)).error(), "parameter name must not be empty");
  EXPECT_EQ(store.declare("none", msg::ParameterValue{}).error(),
            "parameter 'none' cannot be declared without a value");
}

TEST(ParameterStore, TellsWhatIsNewAndWhatHasChanged) {
  std::vector<msg::ParameterEvent> events;
  ParameterStore store("/node",
                       [&](msg::ParameterEvent event) { events.push_back(std::move(event)); });
  ASSERT_TRUE(store.declare("gain", Value(1.0)));
  EXPECT_EQ(set(store, "gain", 2.0), "ok");
  EXPECT_NE(set(store, "gain", false), "ok");
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].node, "/node");
  EXPECT_THAT(events[0].new_parameters, ElementsAre(parameter("gain", 1.0)));
  EXPECT_THAT(events[1].changed_parameters, ElementsAre(parameter("gain", 2.0)));
}

TEST(ParameterStore, AnswersNothingWhenOneNameIsUnknown) {
  const ParameterStore store = store_with("gain", 1.0);
  EXPECT_THAT(store.get_parameters(Names{"gain"}), ElementsAre(to_parameter_value(1.0)));
  EXPECT_THAT(store.get_parameters(Names{"gain", "x"}), IsEmpty());
  EXPECT_THAT(store.get_types(Names{"gain"}), ElementsAre(3));
  EXPECT_THAT(store.get_types(Names{"x"}), IsEmpty());
  EXPECT_EQ(store.describe(Names{"gain"}).front().name, "gain");
  EXPECT_THAT(store.describe(Names{"gain", "x"}), IsEmpty());
}

TEST(ParameterStore, ListsByPrefixAndDepth) {
  ParameterStore store("/node");
  for (const char* name : {"a", "b.c", "b.d.e", "bx"})
    ASSERT_TRUE(store.declare(name, Value(true)));
  EXPECT_THAT(store.list({}, 0).names, ElementsAre("a", "b.c", "b.d.e", "bx"));
  EXPECT_THAT(store.list({}, 0).prefixes, ElementsAre("b", "b.d"));
  EXPECT_THAT(store.list({}, 1).names, ElementsAre("a", "bx"));
  EXPECT_THAT(store.list(Names{"b"}, 0).names, ElementsAre("b.c", "b.d.e"));
  EXPECT_THAT(store.list(Names{"b"}, 2).names, ElementsAre("b.c"));
  EXPECT_THAT(store.list(Names{"a"}, 1).names, ElementsAre("a"));
  EXPECT_THAT(store.list(Names{"z"}, 0).names, IsEmpty());
}

TEST(ParameterStore, ConvertsTheFourTypesOfValues) {
  for (const Value& value :
       {Value(true), Value(std::int64_t{-3}), Value(0.5), Value(std::string("x"))}) {
    EXPECT_EQ(to_value(to_parameter_value(value)), value);
  }
  msg::ParameterValue array;
  array.type = static_cast<std::uint8_t>(msg::ParameterType::kStringArray);
  EXPECT_FALSE(to_value(array));
  EXPECT_FALSE(to_value(msg::ParameterValue{}));
  array.type = 200;
  EXPECT_FALSE(to_value(array));
}

}  // namespace
}  // namespace culprit::ros2

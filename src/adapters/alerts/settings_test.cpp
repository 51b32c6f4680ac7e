#include "alerts/settings.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit::alerts {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

struct SettingsFile {
  Expected<Settings> read(const std::string& text, fs::perms perms = fs::perms::owner_read) const {
    const auto path = folder / "alerts.yaml";
    fs::remove(path);
    std::ofstream(path) << text;
    fs::permissions(path, perms);
    return read_settings(path.string());
  }
  test::TestFolder folder;
};

TEST(AlertSettings, AreReadFromAFile) {
  const auto settings = SettingsFile().read(R"(
page: http://rover.lan:8642   # a comment
wait: 10s
to:
  - slack: https://hooks.slack.com/services/T/B/secret
  - alertmanager: http://[::1]:9093
  - json: https://example.org:8443/hook?robot=1
    ca: /etc/ssl/ours.pem
  - command: [/usr/bin/logger, --priority, alert]
    when: person
)");
  ASSERT_TRUE(settings) << settings.error();
  EXPECT_EQ(settings->page, "http://rover.lan:8642");
  EXPECT_EQ(settings->wait, std::chrono::seconds(10));
  ASSERT_EQ(settings->to.size(), 4u);
  EXPECT_EQ(settings->to[0].name(), "slack at hooks.slack.com") << "and nothing that is secret";
  EXPECT_EQ(settings->to[1].name(), "alertmanager at [::1]");
  EXPECT_EQ(settings->to[2].ca, "/etc/ssl/ours.pem");
  EXPECT_THAT(settings->to[3].command,
              testing::ElementsAre("/usr/bin/logger", "--priority", "alert"));
  EXPECT_TRUE(settings->to[3].only_for_person);
}

TEST(AlertSettings, AreReadByTheirUserOnly) {
  const SettingsFile file;
  const auto settings =
      file.read("to: [{json: http://a}]", fs::perms::owner_read | fs::perms::others_read);
  ASSERT_FALSE(settings);
  EXPECT_THAT(settings.error(), HasSubstr("chmod 600"));
}

TEST(AlertSettings, SayWhatIsWrongAndWhereAndNothingSecret) {
  const SettingsFile file;
  const auto error_of = [&](const std::string& text) {
    const auto settings = file.read(text);
    return settings ? "none: " + text : settings.error();
  };
  EXPECT_THAT(error_of("to:\n  - slakc: https://a/secret"),
              HasSubstr("alerts.yaml:2: there is no setting 'slakc'; did you mean 'slack'?"));
  EXPECT_THAT(error_of("to:\n  - slack: ftp://a/secret"),
              HasSubstr("begins with http:// or https://"));
  EXPECT_THAT(error_of("to:\n  - slack: https://user:secret@a/b"),
              HasSubstr("neither blanks nor a user"));
  EXPECT_THAT(error_of("to:\n  - slack: https://a:99999/secret"), HasSubstr("the port"));
  EXPECT_THAT(error_of("to:\n  - {slack: https://a, json: https://b}"), HasSubstr("one of slack"));
  EXPECT_THAT(error_of("to:\n  - command: logger it"), HasSubstr("a command is a list"));
  EXPECT_THAT(error_of("to: []"), HasSubstr("there has to be a list 'to'"));
  EXPECT_THAT(error_of("wait: 5s"), HasSubstr("there has to be a list 'to'"));
  EXPECT_THAT(error_of("wait: soon\nto: [{json: http://a}]"), HasSubstr("alerts.yaml:1:"));
  EXPECT_THAT(error_of("wait: 2h\nto: [{json: http://a}]"), HasSubstr("from 0s to 1h"));
  EXPECT_THAT(error_of("to: [{json: http://a, when: never}]"),
              HasSubstr("'when' is person, or always"));
  EXPECT_THAT(error_of("to: [{json: https://a/secret"), HasSubstr("this is no YAML"));
  for (const std::string& text :
       {std::string("to:\n  - slack: ftp://a/secret"), std::string("to: [{json: https://a/secret"),
        std::string("- secret")})
    EXPECT_THAT(error_of(text), testing::Not(HasSubstr("secret")));
  EXPECT_FALSE(read_settings("/nowhere/alerts.yaml"));
}

TEST(AlertSettings, TakeTextsOfAnyForm) {
  const SettingsFile file;
  for (const std::string& text :
       {std::string(), std::string("1"), std::string("[]"), std::string("to: 1"),
        std::string("to: {a: b}"), std::string("to: [[[]]]"), std::string("\xff\xfe"),
        std::string(1000, '['), std::string("&a [*a]"), std::string("to: [{json: [1]}]"),
        std::string("? [a]\n: b"), std::string(100'000, 'x')})
    EXPECT_FALSE(file.read(text)) << text.substr(0, 40);
}

}  // namespace
}  // namespace culprit::alerts

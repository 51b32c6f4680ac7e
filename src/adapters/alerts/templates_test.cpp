#include "alerts/templates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "json/json.h"

namespace culprit::alerts {
namespace {

using testing::HasSubstr;
using Kind = Destination::Kind;

Alert dead_camera() {
  Alert alert;
  alert.id = "1-CameraGone";
  alert.robot = "rover";
  alert.host = "rover-pc";
  alert.headline = "camera is down";
  alert.health = "ERROR";
  alert.rule = "CameraGone";
  alert.components = {"camera"};
  alert.consequences = {"FusionSilent", "PoseSilent"};
  alert.doing = "being repaired: redeploy camera";
  alert.began = 1795538700.25;
  alert.link = "http://rover.lan:8642";
  return alert;
}

Alert over(Alert alert) {
  alert.state = Alert::State::kResolved;
  alert.ended = alert.began + 2.5;
  alert.doing = "CameraGone resolved by redeploy";
  return alert;
}

TEST(AlertText, SaysTheBlameTheEffectsAndTheRepair) {
  EXPECT_EQ(text_of(dead_camera()),
            "rover: camera is down (ERROR), so that FusionSilent, PoseSilent fail; being repaired: "
            "redeploy camera");
  EXPECT_EQ(text_of(over(dead_camera())),
            "rover: RESOLVED: camera is down (ERROR), so that FusionSilent, PoseSilent fail, after "
            "2.5 s; "
            "CameraGone resolved by redeploy");
  Alert alert = dead_camera();
  alert.needs_person = true;
  alert.untold = 3;
  EXPECT_THAT(text_of(alert), HasSubstr("rover: A PERSON IS NEEDED: camera is down"));
  EXPECT_THAT(text_of(alert), HasSubstr("3 earlier alerts could not be sent"));
}

TEST(AlertTemplates, GiveSlackATextInWhichNamesAreOnlyText) {
  Alert alert = dead_camera();
  alert.headline = "<!channel> & <http://evil|camera>";
  const Json body = parse_json(body_for(Kind::kSlack, alert));
  EXPECT_THAT(body["text"].get<std::string>(),
              HasSubstr("&lt;!channel&gt; &amp; &lt;http://evil|camera&gt;"));
  EXPECT_THAT(body["text"].get<std::string>(),
              HasSubstr("<http://rover.lan:8642|See it on culprit's page>"));
}

TEST(AlertTemplates, GiveAlertmanagerOneAlertFromItsBeginningToItsEnd) {
  const Json firing = parse_json(body_for(Kind::kAlertmanager, dead_camera()));
  const Json resolved = parse_json(body_for(Kind::kAlertmanager, over(dead_camera())));
  ASSERT_EQ(firing.size(), 1u);
  EXPECT_EQ(firing[0]["labels"], resolved[0]["labels"]);
  EXPECT_EQ(firing[0]["labels"]["robot"], "rover");
  EXPECT_EQ(firing[0]["startsAt"], "2026-11-24T16:45:00.250Z");
  EXPECT_FALSE(firing[0].contains("endsAt"));
  EXPECT_EQ(resolved[0]["endsAt"], "2026-11-24T16:45:02.750Z");
  Alert needed = dead_camera();
  needed.needs_person = true;
  const Json both = parse_json(body_for(Kind::kAlertmanager, needed));
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0]["labels"], firing[0]["labels"]);
  EXPECT_EQ(both[1]["labels"]["alertname"], "CulpritNeedsPerson");
}

TEST(AlertTemplates, FindAlertmanagersApi) {
  const auto path = [](const std::string& url) {
    return path_for(Kind::kAlertmanager, *read_url(url));
  };
  EXPECT_EQ(path("http://a:9093"), "/api/v2/alerts");
  EXPECT_EQ(path("http://a/prefix/"), "/prefix/api/v2/alerts");
  EXPECT_EQ(path("http://a/api/v2/alerts"), "/api/v2/alerts");
  EXPECT_EQ(path_for(Kind::kJson, *read_url("https://a/hook?x=1#y")), "/hook?x=1");
}

TEST(AlertTemplates, GiveProgramsAllThatIsKnown) {
  const Json body = parse_json(body_for(Kind::kJson, over(dead_camera())));
  EXPECT_EQ(body["format"], "culprit-alert");
  EXPECT_EQ(body["state"], "resolved");
  EXPECT_EQ(body["components"], Json::array({"camera"}));
  EXPECT_EQ(body["link"], "http://rover.lan:8642");
  Alert odd = dead_camera();
  odd.headline = "\xff\xfe\n\"";
  EXPECT_TRUE(Json::accept(body_for(Kind::kJson, odd)));
}

}  // namespace
}  // namespace culprit::alerts

#include "init/lasting.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "init/marks.h"

namespace culprit::init {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Lasting : testing::Test {
  // Below the folder for temporary files, as `ros2 launch` makes it.
  std::string temporary(const std::string& name, const std::string& text) {
    const std::filesystem::path path = folder / name;
    std::ofstream(path) << text;
    return path.native();
  }
  test::TestFolder folder;
  RobotProfile seen;
};

TEST_F(Lasting, AFileOfALaunchIsCopiedBesideTheRules) {
  const std::string file =
      temporary("launch_params_x1", "/**:\n  ros__parameters:\n    rate: 10\n");
  seen.starts["/left/camera"].command = {"/ws/driver", "--ros-args", "--params-file", file};
  const Kept kept = keep_parameters(seen, "/home/ann/my.rules");
  EXPECT_THAT(seen.starts["/left/camera"].command,
              ElementsAre("/ws/driver", "--ros-args", "--params-file",
                          "/home/ann/my.left_camera.params.yaml"));
  ASSERT_EQ(kept.files.size(), 1u);
  EXPECT_EQ(kept.files[0].path, "/home/ann/my.left_camera.params.yaml");
  EXPECT_THAT(kept.files[0].text, HasSubstr("    rate: 10\n"));
  EXPECT_TRUE(is_as_written(kept.files[0].text));
  EXPECT_THAT(kept.notes, IsEmpty());
}

TEST_F(Lasting, EachOfSeveralFilesHasACopy) {
  seen.starts["/camera"].command = {"driver", "--params-file", temporary("a", "a: 1\n"),
                                    "--params-file", temporary("b", "b: 1\n")};
  const Kept kept = keep_parameters(seen, "/home/ann/my.rules");
  EXPECT_THAT(seen.starts["/camera"].command,
              ElementsAre("driver", "--params-file", "/home/ann/my.camera.params.yaml",
                          "--params-file", "/home/ann/my.camera.2.params.yaml"));
  EXPECT_EQ(kept.files.size(), 2u);
}

TEST_F(Lasting, AFileOfAPersonStaysWhereItIs) {
  seen.starts["/camera"].command = {"driver", "--params-file", "/opt/robot/camera.yaml"};
  EXPECT_THAT(keep_parameters(seen, "/home/ann/my.rules").files, IsEmpty());
  EXPECT_EQ(seen.starts["/camera"].command[2], "/opt/robot/camera.yaml");
}

TEST_F(Lasting, WhatIsGoneOrCannotBeWrittenIsSaid) {
  seen.starts["/camera"].command = {"driver", "--params-file", "/tmp/no_such_file"};
  EXPECT_THAT(keep_parameters(seen, "/home/ann/my.rules").notes,
              ElementsAre(HasSubstr("/tmp/no_such_file cannot be read")));
  seen.starts["/camera"].command = {"driver", "--params-file", temporary("a", "a: 1\n")};
  EXPECT_THAT(keep_parameters(seen, "").notes, ElementsAre(HasSubstr("with -o")));
}

}  // namespace
}  // namespace culprit::init

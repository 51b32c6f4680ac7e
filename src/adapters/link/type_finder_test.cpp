#include "link/type_finder.h"

#include <fcntl.h>
#include <fstream>
#include <future>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "ros2/live_test.h"
#include "ros2/type_description.h"

namespace culprit::link {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using DescribeType = ros2::srv::GetTypeDescription;

constexpr const char* kType = "my_msgs/msg/Battery";

ros2::MessageDefinitions battery() {
  return {{kType,
           {kType,
            {{.name = "cells",
              .element = "my_msgs/msg/Cell",
              .shape = ros2::Shape::kSequence,
              .count = 0},
             {.name = "charge", .element = ros2::Primitive::kFloat64}}}},
          {"my_msgs/msg/Cell",
           {"my_msgs/msg/Cell", {{.name = "volts", .element = ros2::Primitive::kFloat32}}}}};
}

constexpr const char* kService = "my_msgs/srv/Swap";

// What "my_msgs/srv/Swap" is: it asks for a slot, and is answered by a truth.
ros2::MessageDefinitions swap() {
  ros2::MessageLibrary library;
  library.learn(std::string(kService) + "_Request", "int32 slot\n");
  library.learn(std::string(kService) + "_Response", "bool ok\n");
  return *library.with_parts(kService);
}

std::string request_hash(const std::string& text) {
  ros2::MessageLibrary library;
  library.learn(std::string(kService) + "_Request", text);
  return *library.hash_of(std::string(kService) + "_Request");
}

fs::path with_file(const fs::path& prefix, const std::string& text,
                   const std::string& name = std::string(kType) + ".msg") {
  const fs::path file = prefix / "share" / name;
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
  return prefix;
}

// A process that was started with this AMENT_PREFIX_PATH, and ends with the test.
class StartedWith {
 public:
  explicit StartedWith(const fs::path& prefixes) {
    const std::string variable = "AMENT_PREFIX_PATH=" + prefixes.string();
    int runs[2];
    if (pipe2(runs, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    pid_ = fork();
    if (pid_ == 0) {
      char program[] = "/bin/sleep";
      char time[] = "1000";
      char* arguments[] = {program, time, nullptr};
      char* environment[] = {const_cast<char*>(variable.c_str()), nullptr};
      execve(program, arguments, environment);
      _exit(127);
    }
    close(runs[1]);
    char nothing = 0;
    (void)!::read(runs[0], &nothing, 1);  // ends when its program runs
    close(runs[0]);
  }
  ~StartedWith() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  StartedWith(const StartedWith&) = delete;
  StartedWith& operator=(const StartedWith&) = delete;

  int pid() const { return pid_; }

 private:
  pid_t pid_ = 0;
};

// A finder, and what it finds.
class Finding {
 public:
  explicit Finding(const ros2::TestDomain& domain, TypeFinder::Options options = {})
      : context_(domain.options()) {
    context_.run([&] {
      node_ = std::move(*ros2::Node::create(*context_, {"/", "finder"}));
      finder_ = std::make_unique<TypeFinder>(*node_, std::move(options));
    });
  }
  ~Finding() {
    context_.run([&] {
      finder_.reset();
      node_.reset();
    });
  }

  // The names of the type's fields, of a service those of its request; or why it is not known.
  std::string find(TypeFinder::Offer offer) {
    std::promise<std::string> found;
    context_.run([&] {
      finder_->find(offer, [&](const Expected<ros2::MessageLibrary*>& library) {
        const std::string message = offer.is_service() ? offer.type + "_Request" : offer.type;
        found.set_value(library ? fields_of(**library, message) : library.error());
      });
    });
    return found.get_future().get();
  }

 private:
  static std::string fields_of(ros2::MessageLibrary& library, const std::string& type) {
    std::string names;
    for (const ros2::FieldDefinition& field : (*library.find(type))->fields)
      names += field.name + ' ';
    return names;
  }

  ros2::LiveContext context_;
  std::unique_ptr<ros2::Node> node_;
  std::unique_ptr<TypeFinder> finder_;
};

// A node as Jazzy's, which describes `told` for any request.
class TellingNode {
 public:
  TellingNode(const ros2::TestDomain& domain, const ros2::MessageDefinitions& told,
              const char* type = kType)
      : context_(domain.options()) {
    context_.run([&] {
      node_ = std::move(*ros2::Node::create(*context_, {"/", "driver"}));
      server_ = std::move(*node_->create_service<DescribeType>(
          "~/get_type_description", [told, type](const DescribeType::Request&) {
            DescribeType::Response response;
            response.successful = true;
            response.type_description = ros2::describe(type, told);
            return response;
          }));
    });
  }
  ~TellingNode() {
    context_.run([&] {
      server_.reset();
      node_.reset();
    });
  }

 private:
  ros2::LiveContext context_;
  std::unique_ptr<ros2::Node> node_;
  std::unique_ptr<ros2::ServiceServer> server_;
};

TEST(TypeFinder, TakesTheFilesOfThePublishersProcessWhereNobodyAnnouncesHashes) {
  const ros2::TestDomain domain;
  const test::TestFolder ours;
  const test::TestFolder its;
  with_file(ours.path(), "int32 old\n");
  const StartedWith process(with_file(its.path(), "int32 real\n"));
  Finding finding(domain, {{ours.path()}, {}});
  EXPECT_EQ(finding.find({"/driver", kType, "", process.pid()}), "real ");
  EXPECT_EQ(finding.find({"/elsewhere", kType, "", 0}), "old ");
}

TEST(TypeFinder, SaysWhatToDoWhereThereIsNothing) {
  const ros2::TestDomain domain;
  Finding finding(domain);
  EXPECT_EQ(finding.find({"/driver", kType, "", 0}),
            "the message type my_msgs/msg/Battery is not known; give the directory that holds "
            "my_msgs/msg/Battery.msg with --message-path");
  EXPECT_THAT(finding.find({"/driver", "../etc/passwd", "", 0}),
              HasSubstr("not the name of a type"));
}

TEST(TypeFinder, TakesNoFileOfAnotherTypeThanTheOnePublished) {
  const ros2::TestDomain domain;
  const test::TestFolder ours;
  const test::TestFolder its;
  with_file(ours.path(), "int32 old\n");
  const StartedWith process(with_file(its.path(), "int32 real\n"));
  Finding finding(domain, {{ours.path()}, {}});
  ros2::MessageLibrary real({its.path()});
  EXPECT_EQ(finding.find({"/driver", kType, *real.hash_of(kType), process.pid()}), "real ");
}

TEST(TypeFinder, AsksTheNodeAndKeepsWhatItSays) {
  const ros2::TestDomain domain;
  const test::TestFolder kept;
  const std::string hash = ros2::type_hash(kType, battery());
  const test::TestFolder ours;
  with_file(ours.path(), "int32 old\n");
  {
    const TellingNode driver(domain, battery());
    Finding finding(domain, {{ours.path()}, kept.path() / "types"});
    EXPECT_EQ(finding.find({"/driver", kType, hash, 0}), "cells charge ");
  }
  // No node can be asked any more.
  Finding later(domain, {{ours.path()}, kept.path() / "types"});
  EXPECT_EQ(later.find({"/driver", kType, hash, 0}), "cells charge ");
}

TEST(TypeFinder, BelievesNobodyWhoseWordsDoNotFitTheHash) {
  const ros2::TestDomain domain;
  const test::TestFolder kept;
  const std::string hash = ros2::type_hash(kType, battery());
  ros2::MessageDefinitions forged = battery();
  forged.at(kType).fields.pop_back();
  const TellingNode driver(domain, forged);
  std::ofstream(kept.path() / hash) << "int32 forged\n";
  Finding finding(domain, {{}, kept.path()});
  EXPECT_THAT(finding.find({"/driver", kType, hash, 0}),
              HasSubstr("its node's description differs from the published type"));
  EXPECT_THAT(finding.find({"/driver", kType, "RIHS01_../../etc/passwd", 0}),
              HasSubstr("none that can be checked"));
}

// The parts of an action are enough to make the type of its feedback, and so to know its hash.
TEST(TypeFinder, TakesNoDescriptionThatLacksTheType) {
  const ros2::TestDomain domain;
  const test::TestFolder kept;
  constexpr const char* kPart = "my_msgs/action/Go_Feedback";
  constexpr const char* kWhole = "my_msgs/action/Go_FeedbackMessage";
  const ros2::MessageDefinitions told = {
      {kPart, {kPart, {{.name = "left", .element = ros2::Primitive::kFloat64}}}}};
  ros2::MessageLibrary library;
  library.define(told);
  const std::string hash = *library.hash_of(kWhole);
  const TellingNode driver(domain, told, kPart);
  Finding finding(domain, {{}, kept.path() / "types"});
  EXPECT_THAT(finding.find({"/driver", kWhole, hash, 0}),
              HasSubstr("its node's description differs from the published type"));
}

TEST(TypeFinder, TakesNoDescriptionWithoutAnEnd) {
  const ros2::TestDomain domain;
  const test::TestFolder kept;
  ros2::MessageDefinitions told = battery();
  const std::string name(200, 'c');
  for (int i = 0; i < 1500; ++i)
    told.at(kType).fields.push_back(
        {.name = name + std::to_string(i), .element = ros2::Primitive::kFloat64});
  const TellingNode driver(domain, told);
  Finding finding(domain, {{}, kept.path() / "types"});
  EXPECT_THAT(finding.find({"/driver", kType, ros2::type_hash(kType, told), 0}),
              HasSubstr("its node's description is too long"));
  EXPECT_FALSE(fs::exists(kept.path() / "types"));
}

TEST(TypeFinder, TakesTheFilesOfTheServersProcessForAService) {
  const ros2::TestDomain domain;
  const test::TestFolder ours;
  const test::TestFolder its;
  const std::string file = std::string(kService) + ".srv";
  with_file(ours.path(), "int32 old\n---\n", file);
  const StartedWith process(with_file(its.path(), "int32 slot\n---\nbool ok\n", file));
  Finding finding(domain, {{ours.path()}, {}});
  EXPECT_EQ(finding.find({"/driver", kService, "", process.pid()}), "slot ");
  EXPECT_EQ(finding.find({"/elsewhere", kService, "", 0}), "old ");
  EXPECT_EQ(finding.find({"/elsewhere", "my_msgs/srv/Other", "", 0}),
            "the service type my_msgs/srv/Other is not known; give the directory that holds "
            "my_msgs/srv/Other.srv with --message-path");
}

// From Iron to Kilted: the node cannot be asked, but a request that the server would misread is not
// sent.
TEST(TypeFinder, TakesNoFileOfAnotherServiceThanTheOneOffered) {
  const ros2::TestDomain domain;
  const test::TestFolder ours;
  const std::string file = std::string(kService) + ".srv";
  with_file(ours.path(), "int32 slot\n---\nbool ok\n", file);
  Finding finding(domain, {{ours.path()}, {}});
  EXPECT_EQ(finding.find({"/driver", kService, "", 0, request_hash("int32 slot\n")}), "slot ");
  EXPECT_THAT(finding.find({"/driver", kService, "", 0, request_hash("int64 slot\n")}),
              HasSubstr("is not known as its server means it; give"));
}

// From Lyrical on.
TEST(TypeFinder, AsksTheNodeWhatItsServiceLooksLike) {
  const ros2::TestDomain domain;
  const test::TestFolder kept;
  const test::TestFolder ours;
  with_file(ours.path(), "int32 old\n---\n", std::string(kService) + ".srv");
  const TypeFinder::Offer offer{"/driver", kService, ros2::type_hash(kService, swap()), 0,
                                request_hash("int32 slot\n")};
  {
    const TellingNode driver(domain, swap(), kService);
    Finding finding(domain, {{ours.path()}, kept.path() / "types"});
    EXPECT_EQ(finding.find(offer), "slot ");
  }
  // No node can be asked any more.
  Finding later(domain, {{ours.path()}, kept.path() / "types"});
  EXPECT_EQ(later.find(offer), "slot ");
}

TEST(TypeFinder, WaitsForNobodyForEver) {
  const ros2::TestDomain domain;
  Finding finding(domain);
  EXPECT_THAT(finding.find({"/driver", kType, ros2::type_hash(kType, battery()), 0}),
              HasSubstr("its node does not describe it"));
}

}  // namespace
}  // namespace culprit::link

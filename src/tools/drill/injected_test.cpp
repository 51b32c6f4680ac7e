#include "drill/injected.h"

#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "base/text_file.h"
#include "journal/sealed_file.h"

namespace culprit::drill {
namespace {

using testing::HasSubstr;

struct InjectedFile : testing::Test {
  test::TestFolder folder;
  std::filesystem::path path = folder.path() / "0-rover.drill";
  InjectedRecord record{"boot", {4711, 99}, {}};

  void SetUp() override {
    record.faults.push_back({{FaultKind::kHang, "camera"}, "/camera", {4712, 100}, {}});
    record.faults.push_back(
        {{FaultKind::kSetParameter, "camera", "exposure", Value(0.0)}, "/camera", {}, Value(0.5)});
  }
};

TEST_F(InjectedFile, IsReadAsItWasWritten) {
  EXPECT_FALSE(read_injected(path)->has_value());
  ASSERT_TRUE(write_injected(path, record));
  const auto read = read_injected(path);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(**read, record);
  ASSERT_TRUE(forget_injected(path));
  EXPECT_FALSE(read_injected(path)->has_value());
}

TEST_F(InjectedFile, ThatIsCutAnywhereIsAnError) {
  ASSERT_TRUE(write_injected(path, record));
  const std::string whole = *read_text(path.string());
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    ASSERT_TRUE(write_text(path.string(), whole.substr(0, size)));
    const auto read = read_injected(path);
    ASSERT_FALSE(read) << size;
    EXPECT_THAT(read.error(), HasSubstr(path.string()));
  }
}

TEST_F(InjectedFile, OfStrangeContentIsAnErrorOrNamesNoProcess) {
  for (const char* text :
       {"", "[]", "null", "{}", "{\"faults\": 3}", "{\"faults\": [3]}",
        "{\"faults\": [{\"fault\": {\"kind\": \"melt\", \"component\": \"c\"}}]}",
        "{\"faults\": [], \"faults\": []}"}) {
    ASSERT_TRUE(journal::write_sealed(path, text));
    EXPECT_FALSE(read_injected(path)) << text;
  }
  for (const char* pid : {"-1", "0", "1", "99999999999", "\"4711\"", "null"}) {
    ASSERT_TRUE(journal::write_sealed(
        path,
        "{\"manager\": {\"pid\": " + std::string(pid) +
            ", \"ticks\": 5}, \"faults\": "
            "[{\"fault\": {\"kind\": \"hang\", \"component\": \"c\"}, \"process\": {\"pid\": " +
            pid + ", \"ticks\": 5}}]}"));
    const auto read = read_injected(path);
    ASSERT_TRUE(read) << pid;
    EXPECT_EQ((*read)->manager, ProcessId{}) << pid;
    EXPECT_EQ((*read)->faults.at(0).process, ProcessId{}) << pid;
  }
}

TEST_F(InjectedFile, OnAFullDiskIsNotWrittenAndTheOldOneStays) {
  ASSERT_TRUE(write_injected(path, record));
  // As a full disk does: nothing more can be written to any file.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit none{0, before.rlim_max};
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &none);
  const auto written = write_injected(path, {"boot", {}, {}});
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_FALSE(written);
  EXPECT_EQ(**read_injected(path), record);
}

}  // namespace
}  // namespace culprit::drill

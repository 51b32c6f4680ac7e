// A keystore for tests, as `ros2 security` lays one out, made with openssl.
#pragma once

#include <filesystem>
#include <string>

#include "base/test_folder.h"

namespace culprit::ros2 {

class TestKeystore {
 public:
  // Without enclaves. Gone with the object.
  TestKeystore();
  TestKeystore(const TestKeystore&) = delete;

  // Makes the keys of an enclave ("/culprit") whose members may do what the permissions allow.
  void add(const std::string& enclave, const std::string& permissions);
  // Permissions to publish and subscribe to everything.
  static std::string everything(const std::string& enclave);

  std::string path() const { return folder_.string(); }
  std::filesystem::path file(const std::string& enclave, const std::string& name) const;

 private:
  culprit::test::TestFolder own_;
  std::filesystem::path folder_ = own_.path();
};

}  // namespace culprit::ros2

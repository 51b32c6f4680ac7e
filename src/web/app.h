// The web app, built from ui/ and part of the program: compressed by gzip.
#pragma once

#include <span>
#include <string_view>

namespace culprit::web {

struct Asset {
  std::string_view path;  // "/app.js"
  std::string_view type;  // "text/javascript; charset=utf-8"
  std::string_view gzip;
};

// Empty if the program was built where npm is not installed.
std::span<const Asset> app();

}  // namespace culprit::web
